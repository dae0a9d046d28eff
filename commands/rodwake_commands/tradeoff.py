"""rodwake tradeoff: speed against accuracy. Measures candidates to compute the rods of a scene, or another part of it, unless that is done
already, and names the one asked for."""

import difflib
import math
import os
import subprocess
import sys
import tomllib

from rodwake import InputError, RunError, _core, shipped
from rodwake_commands.tradeoff_parts import BedTarget, FieldTarget, FitTarget
from rodwake_commands.tradeoff_rods import ERRORS, RodsTarget, setting_text
from rodwake_commands.tradeoff_study import Messages, Study, cheapest, most_accurate, pareto_front, quantities, reference_quantity


def main(request):
    core = _core.read_scene(request.text("target"), request.all("set"))
    if request.text("seed"):
        core = _core.apply_seed(core, request.whole("seed", 0))
    scene = tomllib.loads(core.to_toml())
    no_part = [f"{name}=" for name in ("figures", "variants") if name in scene]  # which other keys of the scene may need
    text = _core.parse_scene(core.to_toml(), request.text("target"), no_part).to_toml()
    scene = tomllib.loads(text)
    wanted = wanted_error(request.text("for"))  # what is wrong with a question is known before anything is measured
    target, folder = target_of(request, scene, text, wanted)
    study = Study(target, folder, request.number("limit", 60.0))
    if request.flag("dry_run"):
        describe_work(study)
        return
    study.take_up(request.flag("force"))
    if study.finished:
        request.say(f"measured already in {folder}, with --limit {study.limit:g}s; --force measures anew")
    else:
        measure(request, study)
    (answer_of_rods if target.part == "rods" else answer_of_part)(request, study, wanted)


def target_of(request, scene, text, wanted):
    """The part --of, or else the first that the scene has; and the folder of its results."""
    foreign = scene.get("measure", {}).get("trajectory")
    first = ("rods" if "rods_run" in scene or "scan" in scene else "bed" if "granular" in scene and not foreign else "fit" if "fit" in scene
             else "field" if "field" in scene else "rods")
    part, results, limit = request.text("of", first), request.folder(), request.number("limit", 60.0)
    threads = request.whole("threads", os.cpu_count() or 1)
    given, folder = (scene, text, request.text("target")), results / f"tradeoff_{part}"
    if part == "bed":
        return BedTarget(*given, folder, limit, threads), folder
    if part == "fit":
        return FitTarget(*given, results, limit, threads), folder
    if part == "field":
        return FieldTarget(*given, results, limit), folder
    kind = request.text("error", ERRORS[0])
    if kind not in ERRORS:
        near = difflib.get_close_matches(kind, ERRORS, 1)
        raise InputError(f"--error: {kind} is none of {', '.join(ERRORS)}" + (f' (did you mean "{near[0]}"?)' if near else ""))
    if wanted and (wanted[2] or wanted[0]):
        raise InputError(f'--for "{request.text("for")}": of rods a plain number, such as 1e-6; --error names its kind')
    return RodsTarget(*given, results, limit, kind), results


def wanted_error(text):
    """--for as (quantity, error, whether it is a part of the quantity): "1e-6", "2%", "rod_speed 2 %". None if it was not given."""
    if not text:
        return None
    bare = text.strip()
    relative = bare.endswith("%")
    quantity, _, word = bare.rstrip("% ").rpartition(" ")
    try:
        error = float(word)
    except ValueError:
        raise InputError(f"--for: {word or text} is not a number") from None
    if math.isinf(error):
        raise InputError(f"--for: {word} is too large for a number, which ends at 1.8e308")
    if not error >= 0:
        raise InputError(f"--for: {word} is not from 0 to 1.79769e+308")
    return quantity.strip(), error * (0.01 if relative else 1.0), relative


def describe_work(study):
    candidates, target = study.candidates, study.target
    if target.part == "rods":
        print(f"{len(candidates)} settings would be timed, results in {study.folder}:")
    else:
        print(f"{len(candidates)} candidates would be measured, results in {study.folder}; the reference is {target.reference}:")
    for candidate in candidates:
        rods = candidate.setting and f"rtol {candidate.setting['tolerance']:g}: {setting_text(candidate.setting)}"
        print(f"  {rods or ' '.join(candidate.keys)}")


def measure(request, study):
    """Measures what is left of the study, and draws it."""
    study.folder.mkdir(parents=True, exist_ok=True)
    lock = _core.FolderLock(study.folder)
    messages = Messages(request, study.folder)
    if request.flag("force"):
        study.clear()
    study.measure(messages.log, messages.progress)
    messages.log(f"results in {study.folder}")
    command = [sys.executable, str(shipped.folder("plots") / "rodwake_plot.py"), "--quiet", "--", str(study.folder)]
    if subprocess.run(command, check=False).returncode != 0:
        raise RunError(f"the figures could not be made (see above); the results themselves are in {study.folder}, and rodwake plot {study.folder} "
                       "tries again")
    _core.write_manifest(study.folder)
    del lock


def time_text(seconds):
    return (f"{1e6 * seconds:.3g} us" if seconds < 1e-3 else f"{1e3 * seconds:.3g} ms" if seconds < 1 else f"{seconds:.3g} s" if seconds < 600
            else f"{seconds / 3600:.3g} h")


def print_keys(keys):
    """Lines of a scene file, which -s takes too."""
    for key in keys:
        print(key.replace("=", " = ", 1))


# --- rods and scans -----------------------------------------------------------------------------------------------------


def answer_of_rods(request, study, wanted):
    """The settings that no other one beats; or the one that is cheapest for an error, or most accurate within a time."""
    kind, candidates, within = study.target.kind, study.candidates, request.number("within", 0)
    front = pareto_front(candidates, kind)
    if not wanted and not within:
        if not front:
            raise RunError(f"no setting has a {kind}: the reference ends otherwise; --error names another kind")
        print(f"{'error':>10}  {'time':>12}  {'rhs':>8}  {'rtol':>10}  method, form, field")
        for choice in front:
            setting, count = choice.candidate.setting, choice.candidate.rhs_evaluations
            print(f"{choice.error:>10.2g}  {time_text(choice.seconds):>12}  {count:>8}  {setting['tolerance']:>10g}  {setting_text(setting)}")
        return
    best = cheapest(candidates, kind, wanted[1]) if wanted else most_accurate(candidates, kind, within)
    if not best:
        lacks = f"has an error of {wanted[1]:g} or less" if wanted else f"takes {time_text(within)} or less"
        advice = f"no setting has a {kind}; --error names another kind"
        if front:
            nearest = front[-1] if wanted else front[0]
            advice = f"the {'most accurate' if wanted else 'fastest'} one has an error of {nearest.error:.2g} and takes {time_text(nearest.seconds)}"
        raise RunError(f"no setting that was tried {lacks}: {advice}")
    request.say(f"{kind} {best.error:.2g}; {time_text(best.seconds)} for {study.target.unit}, {best.candidate.rhs_evaluations} right-hand sides")
    print_keys(best.candidate.keys)


# --- beds, fits and field maps ------------------------------------------------------------------------------------------


def amount(error, q):
    """Errors of fits and fields are errors already; those of beds are shown as parts of the value."""
    return f"{100 * error / q.scale:.2g} %" if q.scatter > 0 and q.scale > 0 else f"{error:.2g}"


def answer_of_part(request, study, wanted):
    """All candidates; or the keys and number of runs that are cheapest for an error, or most accurate within a time."""
    part, candidates, within = study.target.part, study.candidates, request.number("within", 0)
    quantity = (wanted[0] if wanted else "") or request.text("error") or next(iter(quantities(candidates)), "")
    first = reference_quantity(part, candidates, quantity)
    if not wanted and not within:
        print_table(study, quantity, first)
        return
    if wanted and wanted[2] and not first.scale > 0:
        raise InputError(f'--for "{request.text("for")}": {quantity} is 0, so no error is a part of it; give the error itself')
    error = wanted[1] * (first.scale if wanted[2] else 1.0) if wanted else 0.0
    best = cheapest(candidates, quantity, error) if wanted else most_accurate(candidates, quantity, within)
    if not best:
        if not wanted:
            raise RunError(f"no candidate that was tried takes {time_text(within)} or less")
        nearest = most_accurate(candidates, quantity, math.inf)
        off = f"; the least biased one is off by {amount(nearest.bias, nearest.found)}" if nearest else ""
        raise RunError(f"no candidate that was tried has a {quantity} within {request.text('for')}{off}")
    q = best.found
    if q.scatter > 0:
        measured = f"measured {amount(q.bias, q)} +- {amount(q.bias_error, q)}"
        request.say(f"{q.quantity} to {amount(best.error, q)}: bias {amount(best.bias, q)} ({measured}), {amount(best.statistical, q)} from the "
                    f"scatter of {best.runs} runs; {time_text(best.seconds)} of CPU")
    else:
        request.say(f"{q.quantity} {best.error:.2g} ({q.unit}) in {time_text(best.seconds)}")
    if wanted and q.bias_error > error:
        request.say("its bias is less certain than the requested error: use a longer --limit with --force")
    print_keys(best.candidate.keys + ([f"granular.runs={best.runs}"] if q.scatter > 0 else []))


def print_table(study, quantity, first):
    print(f"{quantity}{'' if first.unit == '1' else f' ({first.unit})'}, against {study.target.reference}")
    if first.scatter > 0:
        print(f"{'value':>14}  {'bias':>10}  {'runs':>5}  {'error':>10}  {'CPU a run':>10}  keys")
    else:
        print(f"{'error':>10}  {'CPU time':>10}  keys")
    for candidate in study.candidates:
        q, keys = next((q for q in candidate.found if q.quantity == quantity), None), " ".join(candidate.keys)
        if q is None:
            print(f"{'-':>10}  {keys}: {candidate.status}")
        elif first.scatter > 0:
            print(f"{q.value:>14.6g}  {amount(q.bias, q):>10}  {candidate.runs:>5}  {amount(q.error, q):>10}  {time_text(candidate.seconds):>10}  "
                  f"{keys}")
        else:
            print(f"{q.bias:>10.2g}  {time_text(candidate.seconds):>10}  {keys}")
