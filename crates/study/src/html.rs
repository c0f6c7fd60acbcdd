//! Pages in HTML: a template's fields filled in, tables.

use std::io;

use quick_xml::Writer;
use quick_xml::events::BytesText;

type Html = Writer<Vec<u8>>;

/// A cell of a table.
#[derive(Clone, Debug, PartialEq)]
pub struct Cell {
    /// What it says, as plain text.
    pub text: String,
    /// Its class in the style sheet; empty for none.
    pub class: String,
    /// The columns that it fills.
    pub span: usize,
}

impl<T: Into<String>> From<T> for Cell {
    fn from(text: T) -> Self {
        Self { text: text.into(), class: String::new(), span: 1 }
    }
}

/// Fills a template in: `{{name}}` and the like stand for what they say.
pub fn fill(template: &str, fields: &[(&str, String)]) -> String {
    fields.iter().fold(template.to_owned(), |page, (field, text)| page.replace(&format!("{{{{{field}}}}}"), text))
}

/// A table with one line of names above its rows, if there are any.
///
/// # Errors
/// Where it cannot be written, which does not happen in memory.
pub fn table(head: &[Cell], rows: &[Vec<Cell>]) -> io::Result<String> {
    let mut html = Writer::new_with_indent(Vec::new(), b' ', 1);
    html.create_element("table").write_inner_content(|html| {
        if !head.is_empty() {
            write_row(html, "th", head)?;
        }
        rows.iter().try_for_each(|cells| write_row(html, "td", cells))
    })?;
    String::from_utf8(html.into_inner()).map_err(io::Error::other)
}

fn write_row(html: &mut Html, element: &str, cells: &[Cell]) -> io::Result<()> {
    html.create_element("tr").write_inner_content(|html| {
        cells.iter().try_for_each(|cell| {
            let span = cell.span.to_string();
            let class = (!cell.class.is_empty()).then_some(("class", cell.class.as_str()));
            let span = (cell.span != 1).then_some(("colspan", span.as_str()));
            let html = html.create_element(element).with_attributes(class.into_iter().chain(span));
            html.write_text_content(BytesText::new(&cell.text)).map(drop)
        })
    })?;
    Ok(())
}
