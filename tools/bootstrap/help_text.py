"""What ./steer --help prints, also before anything is set up."""

import ast
from pathlib import Path

OWN = {
    "test": "run the linter, the type checker and the tests",
    "env": "print what makes a shell one on the bench's ROS, for eval (bash, zsh, fish)",
    "setup": "make or repair the environment (--check: every file, --clean: from nothing)",
}
_TABLE = Path("src", "steering_bringup", "steering_bringup", "cli", "__init__.py")


def commands(root: Path) -> dict[str, str]:
    """Every command with its line: those of the command line are read from its source."""
    return {**_of_command_line(root / _TABLE), **OWN}


def _of_command_line(file: Path) -> dict[str, str]:
    """The literal table COMMANDS of the command line; empty where it cannot be read."""
    try:
        for node in ast.parse(file.read_text()).body:
            if isinstance(node, ast.Assign) and ast.unparse(node.targets[0]) == "COMMANDS":
                return dict(ast.literal_eval(node.value))
    except (OSError, ValueError, SyntaxError):
        pass
    return {}


def text(root: Path) -> str:
    """The whole help."""
    lines = "\n".join(f"  {name:12} {line}" for name, line in commands(root).items())
    return f"""usage: ./steer COMMAND [OPTIONS]

Open test bench for hydraulic power steering on ROS 2 Jazzy. The first call sets up everything.

commands:
{lines}

'./steer COMMAND --help' explains a command with an example. Start with: ./steer run"""
