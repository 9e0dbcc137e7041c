"""Options of every command, and values for them: usual, at a limit, wrong, and in the words of another country."""

from __future__ import annotations

import random
from collections.abc import Mapping

Options = Mapping[str, tuple[str, ...] | None]
"""Values by option; a flag has none."""

PATHS = (
    "",
    ".",
    "case.toml",
    "a/b/c",
    "../../secret.toml",
    "x" * 300,
    "a\nb.nc",
    "\x1b[31mred.nc",
    "é.nc",
    "-x.nc",
    " .nc",
    "out.nc/",
    "~/x.nc",
    "*.nc",
)
TORQUE = ("50", "50,150", "1e6", "1e-6", "50;150", "-5", "fifty", "", "nan", "50.5", "50,5", "1e7", "1e308", "٥٠",
    "0x10", " 50", "5e1", "50Nm",
          "50 150", "50,50", ",".join(str(n) for n in range(1, 40)), "9" * 500, "inf", "1_0",
          ",".join(["x"] * 20_000))  # fmt: skip
MISALIGNMENT = ("E=0.1", "E=0.1,P=-0.1", "E=5", "P=3", "Sigma=1", "G=-2", "E=0.1,P=", "=", "e=0.1", "E:0.1",
    "E=0.1;P=0.2", "sigma=1", "E=1e-300", "E=9.99", "Sigma=-5", "", "E=,", "E==1", "E=0.1mm", "E=nan", "E=1e300",
    "E=0.1,E=0.2", "Sigma=180", "E=" + "9" * 500, "axle.csv", "case.toml", ".", "/dev/zero")  # fmt: skip
SUPPORTED = ("gearbox-nasa-12x36", "axle-fm-11x41", "supports.toml", "Axle", "", ".", "/dev/null", "/dev/zero",
    "case.toml", "../../secret.toml", "\x1b[2J", "x" * 300)  # fmt: skip
FLANK = ("drive", "coast", "convex", "Drive", "")
SOLVER = ("native", "auto", "clarabel", "osqp", "Native", "magic", "", "piqp", "quadprog", "os:path", "../x", "\x1b[2J")
DEVIATION = ("gear=fm-11x41-worn-gear", "pinion=fm-11x41-worn-pinion", "gear=fm-11x41-worn-pinion", "wheel=x",
    "gear=", "gear=nothing", "gear",
             "gear=/", "gear=.", "gear=/dev/null", "=x", "pinion=fm-11x41-worn-gear", "gear=case.toml",
             "gear=/dev/zero", "gear=\x1b[2J")  # fmt: skip
INTERPOLATION = ("spline", "smooth", "weighted_average", "cubic", "")
FREE = ("radial_distance", "machine_root_angle,radial_distance", "point_radius", "ratio_of_roll", "cutter_tilt",
    "sliding_base_motion_1", "sliding_base_motion_9", "radial_distance,", "", ",", "radial", "x" * 500, "\x1b[2J",
    "cradle_angle,cradle_angle", "blade_curvature", "rake_angle")  # fmt: skip
LARGEST = ("1", "0", "-1", "nan", "inf", "1e9", "1e-9", "x", "1,5")

PAIR: Options = {
    "--flank": FLANK,
    "--misalignment": MISALIGNMENT,
    "--deviation": DEVIATION,
    "--interpolation": INTERPOLATION,
    "--solver": SOLVER,
    "--allow-outside": None,
}
ANALYSIS: Options = {
    **PAIR,
    "--torque": TORQUE,
    "--supports": SUPPORTED,
    "--deviated": ("ease_off", "surface", "x"),
    "--edge-contact": None,
    "--lines-only": None,
}
MARKING: Options = {"--marking": ("10", "0.1", "0", "-5", "nan", "inf", "1e9", "x", "", "1,5", "999", "1000", "10um")}

FRICTION: Options = {
    "--speed": ("500", "500,1500", "0", "-5", "1e9", "500:1500:3", "500:1500", "a:b:c", "1:2:1e9", "nan",
    "500:500:3", "1500:500:3", "1e-9", "",
                "500rpm", "1:2:99999", "1:1e308:3", "1:2:3000"),
    "--temperature": ("60", "90", "0", "-300", "1000", "60,90", "60:90:3", "nan", "", "60C", "363", "-273.15"),
    "--roughness": ("0.8", "0", "0.8/0.4", "0.8/0.4/0.2", "-1", "1000", "0.8/", "/", "0.8,0.8", "nan", "", "1e-9",
    "100"),
    "--oil": ("75w90", "pao-vg100", "none", "", "/", "/dev/null", ".", "75W90", "oil.toml", "case.toml",
    "../../secret.toml", "/etc/passwd"),
    "--friction-model": ("kolivand", "0.05", "xu_kahraman", "-1", "nan", "inf", "0", "", "Kolivand",
    "benedict_kelly", "constant", "1e9",
                         "kolivand_blended", "mixed_lubrication", "mixed-lubrication", "5e-2", "1e308", "1000"),
    "--film-heating": ("none", "gupta_cheng", "murch_wilson", "hot", "", "None", "1"),
    "--clamp-temperature": None,
    "--friction-feedback": None,
}  # fmt: skip
PICTURES = ("pictures", "pictures", *PATHS)
LOAD_CASES = ("duty.csv", "duty.csv", "case", "Case", "case.toml", "r.nc", "no.csv", "", ".", "/dev/null", "/dev/zero",
    "\x1b[2J", "x" * 300)  # fmt: skip
#: Values of what is swept: few points each, or refused.
OVER = ("E=0:0.05:2", "E=-0.05,0,0.05", "P=0.01", "Sigma=-0.02,0.02", "torque=50,100", "torque=50:100:3",
    "E~normal(0,0.03)", "E~uniform(-0.02,0.02)", "P~triangular(-0.1,0,0.1)", "flank=drive,coast", "speed=500,1500",
    "oil=75w90,pao-vg100", "temperature=60,90", "roughness=0.4,0.8", "modification.lengthwise_crowning=0,10",
    "deviation.gear=fm-11x41-worn-gear", "deviation.gear=grid.csv,no.csv", "deviation.gear=/dev/zero",
    "pinion.concave.machine.radial_distance=90,100", "pinion.concave.cutter.blade_pressure_angle=-20,89.9",
    "gear.blank.face_width=0,1e9", "pinion.number_of_teeth=10,11", "contact.segments_per_line=9,10.5",
    "contact.mesh_positions=2,3", "pinion.material.elastic_modulus=0,1e300", "pair.hypoid_offset=-20,1000",
    "E=9.99,-9.99", "E=10", "E=1e300", "E=1e-300,0", "E=0,0", "E=0,-0.0", "E=nan", "E=inf:1:3", "E=nan:1:3",
    "E=0:nan:2", "E=-inf:inf:3", "E=0:1e308:2", "E=1:1:2", "E=0:0:2", "E=1:2:1e9", "E=1:2:1000000000", "E=1:2:1",
    "E=1:2:0", "E=1:2:-3", "E=1:2", "E=1:2:3:4", "E=0,1;0,2", "E=0,,1", "E=0,", "E=,", "E=", "E", "=", "~", "e=0",
    "E=0.1mm", "E=0x10", "E=1_0,2", "E= 0.01 , 0.02 ", "torque=-5", "torque=0", "torque=1e9", "torque=1e-9,50",
    "torque=fifty", "torque=50,50", "speed=0", "speed=-5", "temperature=-300", "roughness=-1,0.4", "roughness=0.8/0.4",
    "oil=", "oil=none", "oil=/dev/zero", "oil=case.toml", "flank=left", "flank=drive,drive",
    "share=1,2", "name=a,b", "contact.torques=50,100", "misalignment.offset=0.1", "title=a", "pair=1", "x.y=1",
    "friction.speed=500", "modification.x=1", "deviation.wheel=x", "a.=1", ".=1", "sample=1,2", "load_case=1,2",
    "mesh_position=1,2", "status=1", "E~normal(0)", "E~normal(0,0)", "E~normal(0,-1)", "E~normal(0,nan)",
    "E~normal(0,1e308)", "E~normal(1e308,1)", "E~uniform(1,0)", "E~uniform(0,1e9)", "E~triangular(0,0,0)",
    "E~triangular(0,0,0.1)", "E~lognormal(0,1)", "E~normal(0,0.03", "E~normal", "E~normal()", "E~normal(0;0,03)",
    "E~normal(0,1)(", "E=normal(0,0.03)", "E~0:1:2", "oil~normal(0,1)", "flank~uniform(0,1)", "torque~normal(50,1)",
    "torque~normal(0,100)", "speed~uniform(500,1500)", "E=" + "9" * 500, "E=" + ",".join(["x"] * 20_000),
    "E=\x1b[2J", "é=1", "x" * 5000 + "=1", "E=٥")  # fmt: skip
KEEP = ("worst=max_pressure:1", "least=peak_to_peak:1", "worst=max_pressure:2", "worst=nothing:1", "worst=status:1",
    "worst=max_pressure:0", "worst=max_pressure:1001", "worst=max_pressure:" + "9" * 500, "worst=max_pressure", "worst",
    "best=max_pressure:1", "worst=:1", "=", "", "worst=torque:1", "worst=efficiency:1", "worst=E:1", "worst=x:1:2",
    "worst=\x1b[2J:1")  # fmt: skip

PROBLEM_FORMATS: Options = {
    "--format": ("nc", "mat", "npz", "qps", "mps", "hdf5", "qpbenchmark", "QPS", ".nc", "", "x"),
    "--form": ("dense", "lifted", "dual", "lcp", ""),
}
RESOLUTIONS = (
    "length=0.01",
    "length=0.01,angle=0.05",
    "length=0",
    "length=nan",
    "length=-1",
    "angle=1e9",
    "x=1",
    "=",
    "",
)
#: Options by command, of which some are given.
OPTIONS: dict[str, Options] = {
    "run": {**ANALYSIS, **MARKING, **FRICTION, "--plots": PICTURES, "--load-cases": LOAD_CASES},
    "sweep": {
        **ANALYSIS,
        **MARKING,
        **FRICTION,
        "--over": OVER,
        "--load-cases": LOAD_CASES,
        "--samples": ("2", "3", "1", "0", "-1", "x", "2.0", "1e9", "16777217", "9" * 400, ""),
        "--seed": ("0", "7", "-1", "x", "1.5", "9" * 400, "9223372036854775807", "9223372036854775808"),
        "--sampler": ("sobol", "latin_hypercube", "Sobol", "monte_carlo", ""),
        "--keep": KEEP,
        "--workers": ("1", "2", "0", "-1", "x", "1.5", "1025", "9" * 400, ""),
        "--scheduler": ("tcp://127.0.0.1:1", "127.0.0.1:1", "", "x", "tcp://", "http://127.0.0.1:1", "tcp://127.0.0.1:x",
        "tcp://127.0.0.1:99999", "tls://127.0.0.1:1", "inproc://x", "ucx://x", "\x1b[2J", "case.toml"),
        "--store": ("store", "store", "case.toml", "out.nc", "pictures", *PATHS),
        "--fresh": None,
        "--plots": PICTURES,
    },
    "vh": {
        **{name: values for name, values in PAIR.items() if name != "--solver"},
        **MARKING,
        "--deviated": ("ease_off", "surface", "x"),
        "--share": ("0.25", "0.4", "0.499", "0.01", "1e-9", "0", "0.5", "1", "-0.1", "nan", "inf", "x", "", "0,25",
        "25%"),
        "--height": ("0.5", "0.1", "0.9", "0", "1", "1e-9", "0.999999", "-1", "nan", "x", "", "0,5"),
        "--largest": ("1", "0.1", "9.9", "10", "1e-9", *LARGEST),
        "--grid": ("2x2", "3x2", "2X2", "1x1", "0x5", "22x2", "-2x2", "2x", "x", "", "2", "2x2x2", "1e1x2", "5,5",
        "9" * 400 + "x2", "999999x999999"),
        "--plots": PICTURES,
    },
    "problems": {**ANALYSIS, **PROBLEM_FORMATS},
    "wear": {
        **PAIR,
        "--supports": SUPPORTED,
        "--torque": ("50", "100=0.5,200=0.5", "0", "-5", "x", "100=1", "nan", "100=0", "1e9", "100=0.5,200=0.4", "=",
        "100=", "100=nan", "100=1e308"),
        "--revolutions": ("1e5", "0", "-1", "nan", "inf", "1e30", "x", "1", "1e9"),
        "--coefficient": ("1e-12", "0", "1e-12/2e-12", "-1", "nan", "1", "1/2/3", "inf", "1e-300", "1e300", "1e-9"),
        "--largest-step": ("0.5", "0", "-1", "nan", "inf", "1e-9", "5", "1e-300", "1e300"),
        "--largest-depth": LARGEST,
        "--most-steps": ("5", "0", "-1", "x", "1.5", "9" * 400, "1"),
    },
    "modify": {
        "--torque": TORQUE, "--supports": SUPPORTED, "--misalignment": MISALIGNMENT, "--flank": FLANK,
        "--solver": SOLVER,
        "--objective": ("peak_load", "peak_pressure", "even_load", "x"), "--order": ("2", "3", "4", "5", "x", "2.0"),
        "--transmission-error": ("10", *LARGEST), "--end-load": ("10", *LARGEST), "--largest": ("10", *LARGEST),
        "--allow-outside": None,
        "--fitted-case": ("fit.toml", "fit.nc", *PATHS), "--force": None,
    },
    "optimize": {
        "--minimize": ("peak_to_peak", "max_pressure", "harmonic_1", "coast.max_pressure", "max_pressure@100",
            "max_pressure@", "peak", "", "harmonic_0", "max_pressure@1e9", "x.peak_to_peak"),
        "--limit": ("max_pressure<=2000", "peak_to_peak@100<=50", "ease_off_change<=20", "root_line_change<=0.05",
            "max_pressure>=1",
            "max_pressure<1", "max_pressure<=-1", "max_pressure<=nan", "x<=1", "", "peak_to_peak=5"),
        "--form": ("worst", "weighted", "pareto", "best", ""),
        "--weight": ("1", "1,2", "0", "-1", "x", "nan", ""),
        "--points": ("2", "3", "1", "0", "-1", "x", "1e3"),
        "--flank": ("drive", "coast", "both", "Drive", ""),
        "--torque": TORQUE, "--misalignment": MISALIGNMENT,
        "--spread": ("E~normal(0,0.01)", "P~uniform(-0.01,0.01)", "E~normal(0,-1)", "E=1", "", "E~normal",
            "x~normal(0,1)"),
        "--samples": ("2", "0", "-1", "x", "1e9"), "--seed": ("0", "7", "-1", "x"),
        "--free": ("pinion.*.machine.radial_distance", "pinion.*.machine.*", "x", "", "gear.*", "*"),
        "--limit-setting": ("*.radial_distance=0:500", "*.radial_distance=5:1", "x=0:1", "*=0:1", "", "a=b:c"),
        "--move": ("50", *LARGEST),
        "--steps": ("1", "2", "0", "-1", "x"),
        "--case": ("best.toml", "best.nc", *PATHS), "--resume": ("best.nc", "out.nc", *PATHS),
        "--resolution": RESOLUTIONS, "--allow-outside": None, "--force": None,
    },
    "verify": {"--allow-outside": None, "--torque": TORQUE, "--supports": SUPPORTED, "--misalignment": MISALIGNMENT,
        "--flank": FLANK, "-o": ("v.nc", "v.txt", *PATHS)},
    "export": {
        "--member": ("pinion", "gear", "wheel"), "--flank": ("concave", "convex", "both", "drive"), "--rows": ("5",
        "2", "1", "-1", "x", "1001", "3"),
        "--columns": ("9", "2", "0", "3"), "--teeth": ("1", "all", "0", "-1", "41", "1000", "x", "", "1e3"),
        "--allow-outside": None,
        "--margins": ("toe=1", "toe=100", "toe=-1", "top=1", "toe=nan", "root=0,tip=0", "toe=1e300",
        "toe=0,heel=0,root=0,tip=0", "", ","),
        "--tolerance": ("10", "-5,10", "10,5", "0", "nan", "1,2,3", "x", "0,5", "", "1e400"),
        "--torque": ("50", "100", "0", "-1", "nan", "inf", "x", "50,100", ""),
        "--mesh-position": ("0", "0.25", "0.5", "1", "-1", "nan", "inf", "x", "0,25", ""),
        "--nodes": ("9x7", "5x5", "1x1", "x", "9", "9x7x5", "9X7", "-5x9", "200x100", "1e3x5"),
    },
    "correct": {
        "--flank": FLANK,
        "--deviation": DEVIATION,
        "--free": FREE,
        "--set-up": ("auto", "own", "shared", "Own", ""),
        "--thickness": ("gear=5", "gear=5,pinion=2", "gear", "gear=nan", "gear=1e9", "wheel=1", "gear=5um", "=", ""),
        "-o": ("corrected.toml", "corrected.nc", *PATHS),
        "--force": None,
        "--plots": PICTURES,
        "--allow-outside": None,
    },
    "compare": {
        "--solvers": ("native", "native,magic", "magic", "", "native,", "os:path", "math:sqrt", "osqp",
        "native,native", "nothing:x", ":", "\x1b[2J"),
        "--repetitions": ("1", "0", "-1", "x", "2"), "--time-limit": ("1", "0", "-1", "nan", "inf", "1e-9"),
        "--tolerance": ("1e-5", "0", "-1", "nan", "1", "inf"), "--raw": None, "--defaults": None, "--polish": None,
        "--tolerances": ("1e-3", "1e-3,1e-6", "1e-3,1e-3", "0", "1", "-1", "nan", "x", "", "1e-3,"),
        "--threads": ("1", "2", "0", "-1", "x"), "--fresh": None, "--test-set": None,
        "--time": ("wall", "processor", "cpu", ""),
    },
    "oil": {
        "--viscosity-40": ("100", "0", "-1", "nan", "inf", "1e9", "5", "1,5", "x", "", "100cSt"),
        "--viscosity-100": ("14", "0", "-1", "nan", "200", "1.0", "1e-9", "100", "14,5"),
        "--density": ("880", "0.88", "0", "-1", "nan", "1e9", "x", "880kg"), "--base-oil": ("mineral", "pao", "pag",
        "ester", "PAO", "", "rape"),
        "--title": ("", "x" * 300, "My oil", "a\nb", 'q"uote', "\x1b[2J", "é\u2028", '"""', "\\"), "--source": ("",
        "my sheet", '"""', "\\", "\x07"),
    },
    "plot": {
        **MARKING,
        "--pictures": ("pressure", "ease_off,pressure", "sweep_map", "efficiency", "wear", "nothing", "", ",",
        "pressure,", "pressure,pressure", "Pressure", "\x1b[2J"),
        "--torque": TORQUE, "--flank": FLANK,
        "--format": ("png", "svg", "pdf", "gif", "PNG", ""),
        "--dpi": ("30", "72", "200", "0", "-1", "29", "1201", "x", "1.5", "9" * 400, ""),
    },
    "report": {
        "--author": ("A. Gear", "", "x" * 300, "\x1b[2J", "<b>"),
        "--limit": ("max_pressure<=1500", "efficiency>=96", "max_pressure=1", "max_presure<=1", "<=", "", "x<=nan"),
        "-o": ("report.html", "report.htm", "report.nc", "r.nc", *PATHS)},
    "cite": {"--bibtex": None},
    "new": {
        "--force": None, "-o": ("new.toml", "new.csv", "case.toml", "new.txt", *PATHS),
        "--ratio": ("3.7", "1", "10", "0.5", "12", "nan", "3,7", "41/11", ""),
        "--torque": ("500", "5", "20000", "0", "-1", "1e9", "nan", "1e-300", "50,100"),
        "--speed": ("3000", "0", "-1", "1e9", "inf", "x"), "--shaft-angle": ("90", "60", "120", "119", "0", "nan"),
        "--offset": ("0", "20", "-5", "500", "nan", "1e300"),
        "--use": ("industrial", "automotive", "truck", "aircraft", "car", "", "\x1b[2J"),
    },
    "design": {
        "--force": None, "--report": None, "--allow-outside": None, "--round": None, "--resolution": RESOLUTIONS
    },
    "sheet": {"--allow-outside": None, "--resolution": RESOLUTIONS, "--without-vh": None},
    "convert": {"--force": None, "--allow-outside": None, **PROBLEM_FORMATS},
    "library": {"--parts": ("x", "", "small,", "small,small", "small;medium", "\x1b[2J")},
    "show": {}, "cases": {}, "completion": {},
}  # fmt: skip
STRAY_WORDS = (
    "extra",
    "--extra",
    "-x",
    "-",
    "--",
    "0.1",
    "0.1,0.2",
    "--help",
    "--version",
    "\x1b[31m",
    "-o",
    "é",
    "\udcff",
    "x" * 100_000,
)


def spoilt(rng: random.Random, command: str, words: list[str], most: int = 3) -> list[str]:
    """Words of a command line with further options, and now and then something else wrong with them."""
    words = list(words)
    known = OPTIONS[command]
    for name in rng.sample(list(known), min(len(known), rng.randint(0 if len(words) > 2 else 1, most))):
        if name in words and rng.random() > 0.05:  # else it comes twice
            at = words.index(name)
            del words[at : at + (1 if known[name] is None else 2)]
        values = known[name]
        words += [name] if values is None else [name, rng.choice(values)]
    if words and rng.random() < 0.15:
        way = rng.choice(["character", "stray", "drop", "swap", "twice"])
        at = rng.randrange(len(words))
        if way == "character":
            cut = rng.randrange(len(words[at]) + 1)
            words[at] = (
                words[at][:cut]
                + rng.choice(["x", " ", "−", "=", ",", ";", "é", "\n", "\x1b[2J", "\udcff"])
                + words[at][cut:]
            )
        elif way == "stray":
            words.insert(at, rng.choice(STRAY_WORDS))
        elif way == "drop":
            del words[at]
        elif way == "swap":
            other = rng.randrange(len(words))
            words[at], words[other] = words[other], words[at]
        else:
            words[at:at] = words[at : at + 2]
    return words
