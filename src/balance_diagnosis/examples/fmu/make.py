"""Makes an FMU of a model in C: python make.py emps_axis FOLDER. Needs a C compiler and FMPy."""

import re
import subprocess
import sys
import zipfile
from pathlib import Path
from tempfile import TemporaryDirectory

import fmpy

HERE = Path(__file__).parent
KINDS = {  # of each model: its inputs and outputs; all else is a parameter or a start
    "emps_axis": (("X", "V", "A", "SIGN"), ("FORCE",)),
    "sliding_mass": (("PUSH",), ("SPEED",)),
}
TUNED = "causality='parameter' variability='tunable' initial='exact'"


def make(name: str, folder: Path) -> Path:
    """Compile HERE/name.c and pack it with its description; return the FMU's path."""
    source = (HERE / f"{name}.c").read_text()
    enumerated = re.sub(r"/\*.*?\*/", "", re.search(r"enum \{(.*?)COUNT", source, re.S)[1])
    names = re.findall(r"\w+", enumerated)
    guid = re.search(r'GUID "(.*)"', source)[1]
    with TemporaryDirectory() as scratch:
        library = Path(scratch) / f"{name}.so"
        headers = Path(fmpy.__file__).parent / "c-code"
        compiler = ["cc", "-O2", "-shared", "-fPIC", f"-I{headers}", f"-I{HERE}"]
        subprocess.run([*compiler, HERE / f"{name}.c", "-o", library, "-lm"], check=True)
        path = folder / f"{name}.fmu"
        with zipfile.ZipFile(path, "w") as packed:
            packed.writestr("modelDescription.xml", _description(name, guid, names))
            packed.write(library, f"binaries/linux64/{name}.so")
    return path


def _description(name: str, guid: str, names: list[str]) -> str:
    inputs, outputs = KINDS[name]
    variables, listed = "", ""
    for k, key in enumerate(names):
        if key in outputs:
            kind, start = "causality='output'", ""
            listed += f"<Unknown index='{k + 1}'/>"
        else:
            kind, start = ("causality='input'" if key in inputs else TUNED), " start='0'"
        variables += (
            f"<ScalarVariable name='{key.lower()}' valueReference='{k}' {kind}>"
            f"<Real{start}/></ScalarVariable>"
        )
    return (
        f"<?xml version='1.0' encoding='UTF-8'?><fmiModelDescription fmiVersion='2.0' "
        f"modelName='{name}' guid='{guid}'><CoSimulation modelIdentifier='{name}' "
        "canHandleVariableCommunicationStepSize='true'/>"
        f"<ModelVariables>{variables}</ModelVariables>"
        f"<ModelStructure><Outputs>{listed}</Outputs></ModelStructure></fmiModelDescription>"
    )


if __name__ == "__main__":
    print(make(sys.argv[1], Path(sys.argv[2])))
