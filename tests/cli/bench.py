"""What the tests in Python share: commands that must end well, demands, and scenarios with the program in a folder of their own."""

import argparse
import contextlib
import json
import pathlib
import subprocess
import sys
import tempfile

from events import HANGS

ROOT = pathlib.Path(__file__).resolve().parents[2]
faults = []


def demand(holds, what, text=""):
    """Ends a scenario that goes wrong. `text` says more."""
    if not holds:
        raise AssertionError(f"{what}\n{text}" if text else what)


def expect(holds, fault, text=""):
    """Keeps a fault for the verdict, and goes on."""
    if not holds:
        faults.append(f"{fault}\n{text}" if text else fault)


def judge(holds, claim, text=""):
    """Prints a claim with whether it holds, and goes on. `text` says more where it does not."""
    print(f"{'passed' if holds else 'FAILED'}  {claim}" + (f"\n{text}" if text and not holds else ""), flush=True)
    expect(holds, f"FAILED  {claim}")
    return holds


def verdict(good="all passed"):
    """Ends the test by its faults."""
    print("\n".join(faults + [f"{len(faults)} failed"]) if faults else good)
    sys.exit(1 if faults else 0)


def skip(why):
    """What ctest reports as skipped."""
    print(f"skipped: {why}")
    sys.exit(77)


def run(*command, code=0, **more):
    """A command, once it has ended with this exit code, or with any if that is None."""
    more = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True, "encoding": "utf-8", "errors": "replace", **more}
    done = subprocess.run([*map(str, command)], check=False, **more)
    demand(code in (None, done.returncode),
           f"exit {done.returncode} in place of {code}: {' '.join(map(str, command))}\n{done.stdout}{done.stderr}")
    return done


def attempt(*command, **more):
    """The exit code of a command, and all that it says."""
    done = run(*command, code=None, stderr=subprocess.STDOUT, **more)
    return done.returncode, done.stdout


def arguments(doc, count):
    """The paths of a command line, which else prints its help."""
    if len(sys.argv) != count + 1 or sys.argv[1] in ("-h", "--help"):
        sys.exit(doc)
    return [pathlib.Path(word).resolve() for word in sys.argv[1:]]


@contextlib.contextmanager
def temporary_folder(kept=None):
    """Or one that is kept."""
    with tempfile.TemporaryDirectory(prefix="cloudbake-test-") as name:
        folder = pathlib.Path(kept or name).resolve()
        folder.mkdir(parents=True, exist_ok=True)
        yield folder


class Bench:
    """The program in a folder of its own."""

    def __init__(self, binary, folder, options):
        self.binary, self.folder, self.options = binary, folder, options

    def path(self, name):
        return self.folder / name

    def write(self, name, text):
        path = self.path(name)
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
        return path

    def json(self, name):
        return json.loads(self.path(name).read_text(encoding="utf-8"))

    def start(self, *words, **more):
        more = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True, "errors": "replace", **more}
        return subprocess.Popen([self.binary, *map(str, words)], cwd=self.folder, **more)

    def run(self, *words, code=0, **more):
        """Exit code as wanted; standard output and errors."""
        done = run(self.binary, *words, code=code, **{"cwd": self.folder, "timeout": HANGS, **more})
        return done.stdout, done.stderr


def run_scenarios(doc, scenarios, make=Bench, together=False, **options):
    """The command line TEST BINARY [--only NAME], with options of its own by name and default. Each scenario gets a bench of its own, or
    all one together."""
    parser = argparse.ArgumentParser(description=doc, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("binary", type=lambda path: pathlib.Path(path).resolve())
    parser.add_argument("--only", choices=[scenario.__name__ for scenario in scenarios])
    for name, default in options.items():
        if default is False:
            parser.add_argument(f"--{name}", action="store_true")
        else:
            parser.add_argument(f"--{name}", type=type(default), default=default)
    chosen = parser.parse_args()
    with temporary_folder() as root:
        bench = None
        for scenario in scenarios:
            if chosen.only not in (None, scenario.__name__):
                continue
            known, note = len(faults), None
            try:
                if not (bench and together):
                    folder = root / scenario.__name__
                    folder.mkdir()
                    bench = make(chosen.binary, folder, chosen)
                note = scenario(bench)
            except AssertionError as error:
                faults.append(note := str(error))
            print(f"{'ok    ' if len(faults) == known else 'FAILED'}  {scenario.__name__}{'  ' + note if note else ''}", flush=True)
    sys.exit(1 if faults else 0)
