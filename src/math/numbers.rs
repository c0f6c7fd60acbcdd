//! All numbers of a structure, one after another: to write them down and to read them back.

/// A structure made of numbers that can be read and replaced one by one.
///
/// Implementations take the structure apart by name, so that a new field cannot be forgotten.
pub trait Numbers {
    /// Calls `visit` with every number, always in the same order.
    fn visit(&mut self, visit: &mut dyn FnMut(&mut f64));
}

/// Visits `parts` one after another.
pub fn visit_all<const N: usize>(parts: [&mut dyn Numbers; N], visit: &mut dyn FnMut(&mut f64)) {
    for part in parts {
        part.visit(visit);
    }
}

impl Numbers for f64 {
    fn visit(&mut self, visit: &mut dyn FnMut(&mut f64)) {
        visit(self);
    }
}

impl<T: Numbers> Numbers for [T] {
    fn visit(&mut self, visit: &mut dyn FnMut(&mut f64)) {
        for element in self {
            element.visit(visit);
        }
    }
}

impl<T: Numbers> Numbers for Vec<T> {
    fn visit(&mut self, visit: &mut dyn FnMut(&mut f64)) {
        self.as_mut_slice().visit(visit);
    }
}

impl<T: Numbers, const N: usize> Numbers for [T; N] {
    fn visit(&mut self, visit: &mut dyn FnMut(&mut f64)) {
        self.as_mut_slice().visit(visit);
    }
}
