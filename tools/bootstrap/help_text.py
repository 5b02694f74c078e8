"""What ./steer --help prints, also before anything is set up."""

COMMANDS = {
    "run": "simulate the steering system; without a scenario: the main job with its page of plots",
    "compare": "compare two recorded runs",
    "list": "list scenarios, node sets, parameters and effects",
    "bench": "measure speed against the targets",
    "test": "run the linter, the type checker and the tests",
    "setup": "make or repair the environment (--check: every file, --clean: from nothing)",
}

HELP = """usage: ./steer COMMAND [OPTIONS]

Open test bench for hydraulic power steering on ROS 2 Jazzy. The first call sets up everything.

commands:
{commands}

./steer COMMAND --help explains a command with an example.""".format(
    commands="\n".join(f"  {name:9} {text}" for name, text in COMMANDS.items())
)
