"""Build of the package: that of setuptools, with Cython for the kernels and, where there is no compiler, with zig's.

A kernel is a Python file that Cython compiles, with the types in the ``.pxd`` file beside it; ``pyproject.toml`` lists
them. Each carries the digest of what it was compiled from, see ``core/kernels.py``.
"""

from __future__ import annotations

import os
import runpy
import shlex
import shutil
import sys
import sysconfig
from pathlib import Path
from typing import Any

from setuptools import build_meta
from setuptools.build_meta import *  # noqa: F403  # all hooks but the two below
from setuptools.command.build_ext import build_ext

#: As fast as it gets with the same bits everywhere: sums in the order of the source, no fused multiplication.
FLAGS = {"unix": ["-O3", "-g0", "-ffp-contract=off"], "msvc": ["/O2", "/fp:precise"]}
ZIG = "ziglang>=0.13"
#: What Cython needs for arrays, as a module of its own.
ARRAYS = "easeoff.core.cython_arrays"
source_digest = runpy.run_path("core/kernels.py")["source_digest"]


def get_requires_for_build_wheel(config_settings: Any = None) -> list[str]:
    """Requirements of a wheel: a compiler among them, where there is none."""
    return [*build_meta.get_requires_for_build_wheel(config_settings), *_compiler()]


def get_requires_for_build_editable(config_settings: Any = None) -> list[str]:
    """Requirements of an installation in place: a compiler among them, where there is none."""
    return [*build_meta.get_requires_for_build_editable(config_settings), *_compiler()]


def _compiler() -> list[str]:
    return [] if os.name == "nt" or _has_compiler() else [ZIG]


def _has_compiler() -> bool:
    """True if the compiler is on the path that Python was built with, or that ``CC`` names."""
    command = shlex.split(os.environ.get("CC") or sysconfig.get_config_var("CC") or "cc")
    return shutil.which(command[0]) is not None


class BuildKernels(build_ext):
    """Compile the kernels; neither C nor objects are left among the sources."""

    def finalize_options(self) -> None:
        """Add the module of what Cython needs for arrays, which else every kernel would hold."""
        kernels = self.distribution.ext_modules
        if kernels[-1].name != ARRAYS:
            of_all = {"define_macros": kernels[0].define_macros, "py_limited_api": True}
            kernels.append(type(kernels[0])(ARRAYS, [], **of_all))
        super().finalize_options()

    def run(self) -> None:
        """Compile with zig where nothing else is there."""
        headers = Path(sysconfig.get_path("include"), "Python.h")
        if not headers.is_file():
            raise SystemExit(f"{headers}: is missing; install the headers of Python (Debian, Ubuntu: python3-dev)")
        if os.name != "nt" and not _has_compiler():
            os.environ["CC"] = f"{shlex.quote(sys.executable)} -m ziglang cc"
            os.environ["LDSHARED"] = f"{os.environ['CC']} -shared"
        super().run()

    def build_extension(self, ext: Any) -> None:
        """Compile a copy of the source, which ends with its digest, among copies of the types that it may use."""
        from Cython.Build import cythonize

        source, copies = _source(ext), Path(self.build_temp) / "sources"
        copy = copies / "easeoff" / source
        for folder in copy.relative_to(copies).parents:
            (copies / folder).mkdir(parents=True, exist_ok=True)
            (copies / folder / "__init__.py").touch()
        if ext.name == ARRAYS:
            copy = copy.with_suffix(".c")
        else:
            for types in source.parent.glob("*.pxd"):
                shutil.copyfile(types, copy.with_name(types.name))
            copy.write_bytes(source.read_bytes() + f'\nSOURCE_DIGEST = "{source_digest(source)}"\n'.encode())
        (extension,) = cythonize(
            [type(ext)(ext.name, [str(copy)])],
            include_path=[str(copies)],
            force=True,
            quiet=True,
            shared_utility_qualified_name=ARRAYS,
        )
        ext.sources, ext.depends = extension.sources, []
        ext.extra_compile_args = FLAGS.get(self.compiler.compiler_type, [])
        linux = self.plat_name.startswith("linux")  # not that of the build where it is for another system
        ext.extra_link_args = ["-s"] if linux else []  # no names of functions: smaller
        super().build_extension(ext)
        ext.sources = [str(source)]


def _source(ext: Any) -> Path:
    """Source of a kernel."""
    return Path(ext.name.removeprefix("easeoff.").replace(".", "/") + ".py")
