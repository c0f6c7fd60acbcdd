"""Checks what an FMU carries by FMI-LS-REF and prints its roles with the sizes of what is in the standard's folder.

    references.py MODEL.fmu

The manifest is valid by the standard's schema and names files that are there; the set of parameters has the FMU's, at their
start values.
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


def main(path):
    schema = etree.XMLSchema(etree.parse(Path(__file__).with_name("schema") / "fmi-ls-ref.xsd"))
    with zipfile.ZipFile(path) as archive:
        manifest = etree.fromstring(archive.read(f"{FOLDER}/fmi-ls-manifest.xml"))
        schema.assertValid(manifest)
        for related in manifest:
            source = normpath(join(FOLDER, unquote(related.get("source"))))
            size = archive.getinfo(source).file_size
            if related.get("role") == "parameter":
                check_parameters(archive.read(source), fmpy.read_model_description(path))
            print(related.get("role"), related.get("type"), source, size)


main(sys.argv[1])
