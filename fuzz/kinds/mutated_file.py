"""Mutated copies of files, each by the mutations of its format."""

from __future__ import annotations

import random
from pathlib import Path
from typing import Any

import tomli_w
from mutations import (
    byte_mutations,
    markup_mutations,
    netcdf_mutations,
    number_changes,
    table_mutations,
    text_mutations,
    toml_mutations,
)
from mutations.case_keys import CASE_KEYS, COMPLIANCE, DESIGN_KEYS, FRICTION, LOAD_CASES, MISALIGNMENT
from mutations.support_keys import SUPPORTS, SUPPORT_KEYS

from .box import Box


def any_mutation(rng: random.Random, box: Box, base: str, name: str = "") -> str:
    """Put a mutated copy of a base file into the folder, by the mutations of its format; return its name."""
    name = name or Path(base).name
    source = box.bases[base]
    suffix = source.suffix
    if suffix == ".nc":
        if rng.random() < 0.4:
            return box.put(name, byte_mutations.mutated(rng, source.read_bytes()))
        (box.folder / name).parent.mkdir(parents=True, exist_ok=True)
        netcdf_mutations.mutate(rng, source, box.folder / name)
        return name
    text = source.read_text(encoding="utf-8")
    if suffix == ".toml":
        keys = _keys(base)
        if keys and rng.random() < 0.25:
            text = number_changes.disturbed(rng, text)
        else:
            text = toml_mutations.mutated(rng, _with_tables(rng, text) if keys is CASE_KEYS else text, keys)
    elif suffix in (".csv", ".dmi"):
        text = table_mutations.mutated(rng, text)
    elif suffix in (".rexs", ".xml"):
        text = markup_mutations.mutated_xml(rng, text)
    elif suffix in (".jsonl", ".json"):
        text = markup_mutations.mutated_json_lines(rng, text)
    else:
        text = text_mutations.mutated(rng, text)
    return box.put(name, text_mutations.encoded(rng, text))


def _keys(base: str) -> dict[str, tuple[Any, ...]] | None:
    """Keys of the kind of a TOML file."""
    kinds = {"design": DESIGN_KEYS, "supports": SUPPORT_KEYS, "oil": None}
    return kinds.get(base.partition("-")[0], CASE_KEYS)


def _with_tables(rng: random.Random, text: str) -> str:
    """Text of a case with optional tables, in which mutations find more to change."""
    tables: tuple[tuple[str, Any, float], ...] = (
        ("friction", FRICTION, 0.5),
        ("compliance", COMPLIANCE, 0.3),
        ("misalignment", MISALIGNMENT, 0.3),
        ("load_cases", LOAD_CASES, 0.3),
        ("supports", rng.choice(SUPPORTS), 0.2),
    )
    for name, table, chance in tables:
        if f"[{name}]" not in text and rng.random() < chance:
            text += "\n" + tomli_w.dumps({name: table})
    return text
