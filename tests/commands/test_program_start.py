"""The program heeds a signal from its first moment on, while all that is large is still to be imported."""

import signal
import subprocess
import sys
import tomllib

import pytest

import sevenbar as sb
from places import ROOT


def printed(code):
    return subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout


def test_the_package_and_its_program_are_imported_without_anything_large():
    code = (
        "import sys, sevenbar, sevenbar.__main__\n"
        "print([name for name in ('numpy', 'typer', 'typing', 'threading', 'sevenbar._core', 'sevenbar.errors') "
        "if name in sys.modules])"
    )
    assert printed(code) == "[]\n"


def test_a_table_is_exported_without_figures_engines_or_meshes(tmp_path):
    code = (
        f"import sys; sys.argv = ['sevenbar', 'export', 'rssr', '--out', {str(tmp_path / 'motion.csv')!r}]\n"
        "from sevenbar.commands.cli import main\n"
        "try:\n    main()\nexcept SystemExit:\n    pass\n"
        "print([name for name in ('matplotlib', 'sevenbar.simulation', 'sevenbar.export.parts', 'trimesh') "
        "if name in sys.modules])"
    )
    assert printed(code).splitlines()[-1] == "[]"


@pytest.mark.parametrize("name", sb.__all__)
def test_every_public_name_is_imported_at_its_first_use(name):
    assert getattr(sb, name) is not None
    assert name in vars(sb) or name == "errors"


def test_the_installed_command_begins_at_the_light_module():
    manifest = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    assert manifest["project"]["scripts"] == {"sevenbar": "sevenbar.__main__:main"}


def test_the_package_is_run_as_the_program_is():
    run = [sys.executable, "-m", "sevenbar", "--version"]
    assert subprocess.run(run, capture_output=True, text=True, check=True).stdout == f"{sb.__version__}\n"


@pytest.mark.skipif(sys.platform == "win32", reason="signals of processes are those of POSIX")
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_a_signal_while_numpy_is_imported_ends_the_program_in_one_line(number):
    # the import itself sends it, at a place where Python alone would print a traceback
    code = (
        "import builtins, os, signal\n"
        "signal.signal(signal.SIGINT, signal.default_int_handler)\n"
        "real = builtins.__import__\n"
        "def first(name, *rest):\n"
        "    if name == 'numpy':\n"
        f"        os.kill(os.getpid(), {int(number)})\n"
        "    return real(name, *rest)\n"
        "builtins.__import__ = first\n"
        "from sevenbar.__main__ import main\n"
        "main()\n"
    )
    ended = subprocess.run(
        [sys.executable, "-c", code, "analyze", "rssr"], capture_output=True, text=True, check=False
    )
    assert (ended.returncode, ended.stdout, ended.stderr) == (
        128 + number,
        "",
        "sevenbar: stopped; nothing is written\n",
    )


@pytest.mark.skipif(sys.platform == "win32", reason="signals of processes are those of POSIX")
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
@pytest.mark.parametrize(
    "within",
    [
        # Python remembers that Ctrl+C came within a text that was run, and would end by SIGINT whatever follows
        "exec('import os; os.kill(os.getpid(), {number})')",
        # an import in which a signal comes may fail as that of a library that is missing
        "try:\n        os.kill(os.getpid(), {number})\n    except KeyboardInterrupt:\n"
        "        raise sb.errors.MissingExtraError('step needs build123d') from None",
    ],
)
def test_a_signal_at_work_ends_with_its_code_wherever_it_came(number, within):
    code = (
        "import os, signal, sys\n"
        "signal.signal(signal.SIGINT, signal.default_int_handler)\n"
        "import sevenbar as sb\n"
        "from sevenbar.__main__ import main\n"
        "import sevenbar.description.gallery as gallery\n"
        "def names():\n"
        f"    {within.format(number=int(number))}\n"
        "gallery.names = names\n"
        "sys.argv = ['sevenbar', 'gallery']\n"
        "main()\n"
    )
    ended = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert (ended.returncode, ended.stdout, ended.stderr) == (
        128 + number,
        "",
        "sevenbar: stopped; nothing is written\n",
    )
