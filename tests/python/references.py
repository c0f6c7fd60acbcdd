"""Checks what an FMU carries by FMI-LS-REF and prints its roles with the sizes of what is in the standard's folder.

    references.py MODEL.fmu

The manifest and the experiment are valid by their schemas and name files that are there; the set of parameters has the FMU's,
at their start values. Terminals are valid by FMI 3.0's schema, and their members are variables of the FMU.
"""

import sys
import zipfile
from pathlib import Path
from posixpath import join, normpath
from urllib.parse import unquote

import fmpy
from lxml import etree

FOLDER = "extra/org.fmi-standard.fmi-ls-ref"
SSV = "{http://ssp-standard.org/SSP1/SystemStructureParameterValues}"


def check_parameters(text, description):
    """Compares a parameter set with the start values of the FMU's description."""
    found = {}
    for parameter in etree.fromstring(text).iter(f"{SSV}Parameter"):
        (value,) = parameter
        found[parameter.get("name")] = (value.tag.removeprefix(SSV), value.get("value"))
    parameters = [variable for variable in description.modelVariables if variable.causality == "parameter"]
    expected = {variable.name: (variable.type, variable.start) for variable in parameters}
    if found != expected:
        raise SystemExit(f"parameters: expected {expected}, found {found}")


def valid(text, schema):
    """A document that is valid by a schema."""
    document = etree.fromstring(text)
    etree.XMLSchema(etree.parse(schema)).assertValid(document)
    return document


def check_terminals(archive, description):
    """The terminals of an archive."""
    schema = Path(fmpy.__file__).parent / "schema/fmi3/fmi3TerminalsAndIcons.xsd"
    root = valid(archive.read("terminalsAndIcons/terminalsAndIcons.xml"), schema)
    if root.find("GraphicalRepresentation/Icon") is not None:
        archive.getinfo("terminalsAndIcons/icon.png")
    causality = {variable.name: variable.causality for variable in description.modelVariables}
    members = [member.get("variableName") for member in root.iter("TerminalMemberVariable")]
    print("terminal", *root.xpath("//Terminal/@name"), *[f"{name}:{causality[name]}" for name in members])


def main(path):
    schemas = Path(__file__).with_name("schema")
    with zipfile.ZipFile(path) as archive:
        check_terminals(archive, fmpy.read_model_description(path))
        manifest = valid(archive.read(f"{FOLDER}/fmi-ls-manifest.xml"), schemas / "fmi-ls-ref.xsd")
        for related in manifest:
            source = normpath(join(FOLDER, unquote(related.get("source"))))
            size = archive.getinfo(source).file_size
            if source.endswith(".exp"):
                experiment = valid(archive.read(source), schemas / "ma-hs-experiments.xsd")
                for table in experiment.xpath("//@source"):
                    archive.getinfo(f"{FOLDER}/{table}")
            if related.get("role") == "parameter":
                check_parameters(archive.read(source), fmpy.read_model_description(path))
            print(related.get("role"), related.get("type"), source, size)


main(sys.argv[1])
