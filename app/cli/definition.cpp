// The verbs and their options, as CLI11 takes them: parsing, help, the man page and completion follow from
// these.

#include "definition.hpp"

#include "rodwake/core/build_info.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <limits>
#include <map>

namespace rodwake::cli {

namespace {

constexpr const char* exit_codes =
    "Exit codes: 0 ok, 1 runtime failure, 2 usage or scene error, 3 finished with failed points,\n"
    "            130/143 stopped by Ctrl-C/SIGTERM.\n";

constexpr std::uint64_t largest_seed = 9223372036854775807; // 2^63 - 1, the largest integer a scene can hold

/// Flags of the verbs that compute something of a scene.
void add_scene(CLI::App& verb, Options& options) {
    verb.add_option("SCENE", options.target, "scene file (TOML)")->required();
    verb.add_option("-s,--set", options.overrides, "change a key of the scene: table.key=value; repeatable")
        ->allow_extra_args(false);
    verb.add_option("-o,--output", options.output, "folder for the results [results/<scene name>]");
    verb.add_option("--seed", options.seed, "seed of all random numbers, 0 to 2^63 - 1")
        ->check(whole_number_from(0, largest_seed));
}

void add_quiet(CLI::App& verb, Options& options, const char* does = "no progress, no summary; errors only") {
    verb.add_flag("--quiet", options.quiet, does);
}

void add_force(CLI::App& verb, Options& options, const char* does = "replace a finished run") {
    verb.add_flag("--force", options.force, does);
}

void add_dry_run(CLI::App& verb, Options& options) {
    verb.add_flag("--dry-run", options.dry_run, "print what would be done, do nothing");
}

void add_threads(CLI::App& verb, Options& options) {
    verb.add_option("-j,--threads", options.threads, "threads, at most [one for each core]")
        ->check(whole_number_from(1, 1024));
}

void add_run(CLI::App& verb, Options& options) {
    add_threads(verb, options);
    add_force(verb, options);
    add_dry_run(verb, options);
    add_quiet(verb, options);
    verb.add_flag("-v,--verbose", options.verbose, "more detail")->excludes("--quiet");
    verb.add_option("--log-json", options.json_log, "also log to FILE, one JSON object a line");
}

CLI::App* add_verb(CLI::App& app, Options& options, Verb verb, const std::string& name,
                   const std::string& does, const std::string& examples) {
    CLI::App* sub = app.add_subcommand(name, does);
    sub->footer("Examples:\n" + examples + "\n" + exit_codes);
    sub->callback([&options, verb] { options.verb = verb; });
    return sub;
}

CLI::App* add_stage_verb(CLI::App& app, Options& options, Verb verb, const std::string& name,
                         const std::string& does, const std::string& examples) {
    CLI::App* sub = add_verb(app, options, verb, name, does, examples);
    add_scene(*sub, options);
    add_run(*sub, options);
    return sub;
}

void add_scenes(CLI::App& app, Options& options) {
    CLI::App* scenes = add_verb(app, options, Verb::scenes, "scenes",
                                "list the scenes that are shipped; print one; copy them all",
                                "  rodwake scenes\n"
                                "  rodwake scenes pair > my.toml\n"
                                "  rodwake scenes -o .");
    CLI::Option* name = scenes->add_option("NAME", options.target, "print this scene");
    scenes->add_option("-o,--output", options.output, "copy all into scenes and fitting of this folder")
        ->excludes(name);
    add_force(*scenes, options, "replace files that differ");
    add_quiet(*scenes, options, "do not list the files copied");
}

void add_new(CLI::App& app, Options& options) {
    CLI::App* verb = add_verb(app, options, Verb::new_scene, "new",
                              "write a new scene from three questions, or from the options below",
                              "  rodwake new my.toml\n"
                              "  rodwake new --kind rods --rods 3 --kappa 2 > three.toml\n"
                              "  rodwake new --kind bed --phi-b 0.7 bed.toml\n"
                              "  rodwake new --kind scan --start parallel --kappa 100 phase.toml");
    verb->add_option("FILE", options.target, "file to write [standard output]");
    for (const Question& question : new_scene_questions())
        verb->add_option(question.option, options.answers[question.option],
                         fmt::format("{}{} [{}]", question.text,
                                     question.kinds.empty() ? "" : "; for --kind " + question.kinds,
                                     question.fallback))
            ->check(question.legal);
    add_force(*verb, options, "replace FILE if it exists");
}

void add_field(CLI::App& app, Options& options) {
    CLI::App* field =
        add_verb(app, options, Verb::field, "field", "field of one rod, at points or on a scene's grid",
                 "  rodwake field --points points.csv > field.csv\n"
                 "  rodwake field scenes/ufield.toml -o results/ufield");
    add_scene(*field, options);
    field->get_option("SCENE")->required(false)->description("scene file with a [field] table");
    add_run(*field, options);
    field->add_option(
        "--points", options.points,
        "CSV with columns x,y,xi,eta (- for standard input); the field goes to standard output");
    field
        ->add_option(
            "--backend", options.backend,
            "evaluation of --points: exact, or table: from tables to --table-tolerance, made for each "
            "eta of a thousand points or more (fewer, and boxes, are exact)")
        ->check(one_of({"exact", "table"}));
    field->add_option("--table-tolerance", options.table_tolerance, "relative error of tables, 1e-12 to 0.1")
        ->check(number_from(1e-12, 0.1));
}

void add_tradeoff(CLI::App& app, Options& options) {
    CLI::App* tradeoff =
        add_verb(app, options, Verb::tradeoff, "tradeoff",
                 "benchmark solver settings of a scene; print the cheapest for a given error",
                 "  rodwake tradeoff scenes/pair.toml\n"
                 "  rodwake tradeoff scenes/pair.toml --for 1e-6\n"
                 "  rodwake tradeoff scenes/pair.toml --within 1ms --error path\n"
                 "  rodwake tradeoff scenes/phase_perpendicular.toml --for 0.01 --error outcome\n"
                 "  rodwake tradeoff scenes/granular_quick.toml --for \"rod_speed 5%\"\n"
                 "  rodwake tradeoff fitting/problems/monopole.toml --of fit --for \"optimum 0.01\"");
    add_scene(*tradeoff, options);
    add_run(*tradeoff, options);
    tradeoff->get_option("--threads")
        ->description("threads of references and of runs of a bed; settings are timed on one");
    tradeoff
        ->add_option("--of", options.answers["of"],
                     "rods (or their scan), bed, fit or field [the first of these in the scene]")
        ->check(one_of({"rods", "bed", "fit", "field"}));
    CLI::Option* error = tradeoff->add_option("--for", options.answers["for"],
                                              "print the cheapest setting whose error is at most this, as "
                                              "keys of the scene: 1e-6; for a bed 2% or \"T_xy 1%\"");
    tradeoff
        ->add_option("--within", options.answers["within"],
                     "print the most accurate setting that takes at most this: 5ms, 2s, 1min")
        ->transform(seconds())
        ->excludes(error);
    tradeoff
        ->add_option(
            "--error", options.answers["error"],
            "quantity whose error counts: for rods final_state, contact_time, outcome (fraction that "
            "differs) or path (at all output times); for a bed rod_speed, T_xy, T_z, psi6, wake, ...; for a "
            "fit optimum, interval or objective; for a field displacement, strain or gradients [the first]")
        ->option_text("KIND");
    tradeoff
        ->add_option("--limit", options.answers["limit"],
                     "abandon settings that take longer; for a bed, CPU time per setting [60s]")
        ->transform(seconds());
}

void add_design(CLI::App& app, Options& options) {
    CLI::App* design =
        add_verb(app, options, Verb::design, "design",
                 "rank candidate experiments by how well they would discriminate between the models of a fit",
                 "  rodwake design experiment.toml --vary rods.1.position.1=-1.5,-2,-3 --runs 1,5,20\n"
                 "  rodwake design experiment.toml --list designs.csv --sets 50 -o results/designs");
    add_scene(*design, options);
    add_threads(*design, options);
    add_force(*design, options, "replace design.csv and design.json");
    add_dry_run(*design, options);
    add_quiet(*design, options);
    design
        ->add_option("--vary", options.vary,
                     "values of a key of the scene: table.key=1,2,3; repeatable, all combinations")
        ->allow_extra_args(false);
    design
        ->add_option("--list", options.answers["list"], "CSV with keys in its header and one design per row")
        ->excludes("--vary");
    design->add_option("--runs", options.answers["runs"], "numbers of runs of each design: 1,5,20 [1]");
    design
        ->add_option("--sets", options.answers["sets"],
                     "synthetic experiments for each model and design [20]")
        ->check(whole_number_from(2, 100000));
}

void add_stage_verbs(CLI::App& app, Options& options) {
    add_stage_verb(app, options, Verb::rods, "rods", "integrate the rods of a scene",
                   "  rodwake rods scenes/pair.toml -o results/pair\n"
                   "  rodwake rods scenes/pair.toml -s coupling.kappa=100 -s rods_run.method=bdf");
    add_stage_verb(app, options, Verb::dem, "dem", "simulate the granular bed of a scene; rerun to resume",
                   "  rodwake dem scenes/granular_quick.toml\n"
                   "  rodwake dem scenes/pair_crystal.toml -s granular.phi_b=0.70 -s granular.runs=50 -j 2 "
                   "-o results/fluid");
    add_stage_verb(
        app, options, Verb::measure, "measure",
        "compute the observables listed in [measure] from a granular run or a trajectory file, and those of "
        "[rods_order] from its rods",
        "  rodwake measure scenes/wake.toml\n"
        "  rodwake measure scenes/wake.toml -s measure.displacement=lagrangian --force\n"
        "  rodwake measure scenes/wake.toml -s measure.trajectory=other/trajectory.h5md -o results/other\n"
        "  rodwake measure scenes/crowd.toml -s rods_order.link=1 --force");
    add_stage_verb(
        app, options, Verb::fit, "fit",
        "fit elastic parameters and couplings to measured profiles, maps and tracks, with standard errors",
        "  rodwake fit fitting/problems/monopole.toml -o results/monopole\n"
        "  rodwake fit scenes/quickstart.toml -s fit.starts=50 -j 2 --force");
    CLI::App* scan =
        add_verb(app, options, Verb::scan, "scan", "vary keys of a scene over a design: phase diagrams",
                 "  rodwake scan scenes/phase_perpendicular.toml -j 2\n"
                 "  mpiexec -n 64 rodwake scan scenes/phase_gamma_zero.toml -o results/gamma\n"
                 "  rodwake scan scenes/phase_perpendicular.toml -s scan.resolution=512\n"
                 "  rodwake scan scenes/phase_alpha.toml -s scan.design=grid -o results/alpha --part 3/16\n"
                 "  rodwake scan scenes/phase_alpha.toml -s scan.design=grid -o results/alpha --merge\n"
                 "  rodwake scan scenes/phase_perpendicular.toml --rerun-failed");
    add_scene(*scan, options);
    add_run(*scan, options);
    scan->add_option("--part", options.part,
                     "i/n: only the i-th of n shares of the points (i from 1), into its own folder below -o");
    scan->add_flag("--merge", options.merge,
                   "merge the shares below -o, evaluate missing points, write the results")
        ->excludes("--part");
    scan->add_flag("--rerun-failed", options.rerun_failed, "evaluate failed points again");
    add_tradeoff(app, options);
    add_design(app, options);
    CLI::App* run = add_stage_verb(app, options, Verb::run, "run",
                                   "run every stage of the scene, then make figures and report.html",
                                   "  rodwake run scenes/quickstart.toml\n"
                                   "  rodwake run scenes/attraction.toml -o results/attraction --force");
    run->add_flag("--no-figures", options.no_figures,
                  "results only, as where Python has no matplotlib; rodwake plot draws them later");
}

void add_camera(CLI::App& app, Options& options) {
    CLI::App* camera = add_verb(
        app, options, Verb::camera, "camera",
        "simulate imaging of a bed: tracks with noise, losses and distortion",
        "  rodwake camera results/rod_in_bed && rodwake run results/rod_in_bed/camera/camera.toml\n"
        "  rodwake camera results/bed -o film --pixel \"12.4 um\" --noise \"0.05 a\" --lost 0.1 --view 0.5");
    camera->add_option("RUN", options.target, "run directory with trajectory.h5md, or that file")->required();
    camera->add_option("-o,--output", options.output, "folder for tracks.csv and camera.toml [RUN/camera]");
    camera->add_option("--pixel", options.answers["pixel"],
                       "size of a pixel: \"0.05 a\", \"12.4 um\" [0.05 a]");
    camera->add_option("--every", options.answers["every"], "frames of the run per picture [1]")
        ->check(whole_number_from(1, 1000000));
    camera
        ->add_option("--exposure", options.answers["exposure"],
                     "frames over which a picture is exposed, at most --every [1]")
        ->check(whole_number_from(1, 1000000));
    camera
        ->add_option("--view", options.answers["view"],
                     "side of the picture as a fraction of the box side, above 0 to 1 [1]")
        ->check(number_from(0.0, 1.0));
    camera
        ->add_option("--turned", options.answers["turned"],
                     "rotation of the camera, anticlockwise, degrees, -360 to 360 [0]")
        ->check(number_from(-360.0, 360.0));
    camera
        ->add_option("--distortion", options.answers["distortion"],
                     "radial distortion: relative shift of the corners, -0.1 to 0.1 [0]")
        ->check(number_from(-0.1, 0.1));
    camera
        ->add_option("--lost", options.answers["lost"],
                     "fraction of particles not detected, 0 to below 1 [0]")
        ->check(number_from(0.0, 1.0));
    camera
        ->add_option("--memory", options.answers["memory"],
                     "frames a particle may be missing before it gets a new ID [3]")
        ->check(whole_number_from(0, 1000000));
    camera->add_option("--noise", options.answers["noise"],
                       "standard deviation of a detected coordinate, a length [0]");
    camera
        ->add_option("--images", options.answers["images"],
                     "number of pictures to draw, starting with the first: images/000000.png [0]")
        ->check(whole_number_from(0, 1000000));
    camera
        ->add_option("--blur", options.answers["blur"],
                     "standard deviation of the blur in the pictures, pixels, 0.1 to 20 [1]")
        ->check(number_from(0.1, 20.0));
    camera
        ->add_option("--photons", options.answers["photons"],
                     "photons of a white pixel, which set the shot noise, 1 to 1e9 [1000]")
        ->check(number_from(1.0, 1e9));
    camera->add_option("--seed", options.seed, "seed of losses and noise, 0 to 2^63 - 1 [1]")
        ->check(whole_number_from(0, largest_seed));
    add_force(*camera, options, "replace earlier tracks");
    add_quiet(*camera, options);
}

void add_replay(CLI::App& app, Options& options) {
    CLI::App* replay =
        add_verb(app, options, Verb::replay, "replay", "recompute frames of a finished bed, bit for bit",
                 "  rodwake replay results/bed --from 3 --to 5 --frames 0.01\n"
                 "  rodwake replay results/bed --verify     # the whole run, and where bits first differ");
    replay->add_option("RUN", options.target, "run directory of a bed, or its archive.rwc")->required();
    replay->add_option("--from", options.replay.from, "time of the first frame, s [0]");
    replay->add_option("--to", options.replay.to, "time of the last frame, s [the end of the run]");
    replay->add_option("--frames", options.replay.interval, "interval of the frames, s [as in the run]");
    replay->add_option("-o,--output", options.output, "folder for trajectory.h5md [RUN/replay]");
    replay->add_flag("--verify", options.verify,
                     "recompute the whole run and compare it with its stored states");
    add_threads(*replay, options);
    add_force(*replay, options, "replace an existing trajectory");
    add_quiet(*replay, options);
}

void add_convert(CLI::App& app, Options& options) {
    CLI::App* convert = add_verb(app, options, Verb::convert, "convert",
                                 "convert tracks and trajectories between CSV, H5MD, GSD, extended XYZ and "
                                 "LAMMPS dumps; read TrackMate",
                                 "  rodwake convert results/bed -o bed.gsd\n"
                                 "  rodwake convert results/bed -o bed.xyz --frames 0::10 --rods poses\n"
                                 "  rodwake convert tracks.xml -o film.h5md\n"
                                 "  rodwake convert dump.lammpstrj -o film.csv --rod-kind 2");
    app::ConvertRequest& c = options.convert;
    convert
        ->add_option("IN", options.target, "file of tracks, trajectory, or the folder of a run or ensemble")
        ->required();
    convert
        ->add_option("-o,--output", options.output,
                     "file to write; its ending is the format: .h5md, .gsd, .xyz, .dump, .csv")
        ->required();
    convert->add_option("--frames", c.frames, "frames FROM:TO:STRIDE, numbers from 0 [all]");
    convert
        ->add_option("--rods", c.rods,
                     "poses, or spheres where the file has them [poses in CSV, else spheres]")
        ->check(one_of({"poses", "spheres"}));
    convert->add_option("--unit", c.unit, "of the lengths written: a or m [a for beds, else as in the file]")
        ->check(one_of({"a", "m"}));
    convert->add_option("--format", options.format, "of IN [by its content, else its ending]")
        ->check(one_of({"csv", "trackmate", "lammps", "xyz", "gsd", "h5md"}));
    convert->add_option("--group", c.group, "particles of an H5MD file with several groups");
    convert
        ->add_option("--rod-kind", c.columns.rod_kinds, "a type, species or kind that is a rod; repeatable")
        ->allow_extra_args(false);
    convert
        ->add_option("--column", options.columns,
                     "name of a column: frame, id, x, y, heading or kind, as in id=label; repeatable")
        ->allow_extra_args(false);
    convert->add_option("--time-column", c.columns.time,
                        "column of CSV, or key of extended XYZ, with the times in s");
    add_force(*convert, options, "replace the file if it exists");
    add_quiet(*convert, options);
}

void add_explore(CLI::App& app, Options& options) {
    CLI::App* explore = add_verb(app, options, Verb::explore, "explore",
                                 "write an interactive page for a browser: drag two rods and see their "
                                 "wakes, encounter and phase diagram",
                                 "  rodwake explore\n"
                                 "  rodwake explore scenes/pair.toml -o pair.html -s coupling.kappa=100");
    explore->add_option("SCENE", options.target, "scene file whose first two rods the page starts with");
    explore
        ->add_option("-s,--set", options.overrides, "change a key of the scene: table.key=value; repeatable")
        ->allow_extra_args(false);
    explore->add_option("-o,--output", options.output, "the page, one HTML file [explore.html]");
    add_force(*explore, options, "replace the page if it exists");
    add_quiet(*explore, options);
}

void add_verbs(CLI::App& app, Options& options) {
    add_scenes(app, options);
    add_new(app, options);
    CLI::App* check =
        add_verb(app, options, Verb::check, "check",
                 "validate a scene; print what will be modelled and what not, and what each part will cost",
                 "  rodwake check scenes/quickstart.toml\n"
                 "  rodwake check scenes/pair.toml -s coupling.kappa=100\n"
                 "  rodwake check scenes/pair.toml --quiet && echo valid");
    add_scene(*check, options);
    add_quiet(*check, options, "validate only: errors are printed, nothing is timed");
    add_field(app, options);
    add_stage_verbs(app, options);
    CLI::App* impact = add_verb(app, options, Verb::impact, "impact",
                                "evaluate the contact law for single impacts, one per row",
                                "  rodwake impact --cases cases.csv > impacts.csv");
    impact
        ->add_option("--cases", options.cases,
                     "CSV with columns Kxx,Kxy,Kxz,Kyy,Kyz,Kzz,vx,vy,vz,mu,e (- for standard input); "
                     "Px,Py,Pz,wx,wy,wz go to standard output")
        ->required();
    add_dry_run(*impact, options);
    add_camera(app, options);
    add_convert(app, options);
    add_replay(app, options);
    add_explore(app, options);
    CLI::App* plot =
        add_verb(app, options, Verb::plot, "plot", "make figures and report from the results of a run",
                 "  rodwake plot results/quickstart --pdf\n"
                 "  rodwake plot results/pair --width column --style paper --film\n"
                 "  rodwake plot /archive/pair -o figures --font-size 9 --overlay");
    plot->add_option("RESULT", options.target, "run directory, or its result.h5")->required();
    plot->add_option("-o,--output", options.output,
                     "folder for figures and report, which then leaves RESULT as it is [RESULT]");
    plot->add_flag("--pdf", options.pdf, "PDF in addition to each PNG");
    plot->add_option(
        "--width", options.figure_width,
        "width of figures: column, page, or a length such as 86mm; several panels take two columns");
    plot->add_option("--style", options.figure_style,
                     "paper (the default), slides, or a matplotlib style file");
    plot->add_option("--font-size", options.font_size,
                     "of axis numbers and legends in points, 4 to 40; other text in proportion");
    plot->add_flag("--overlay", options.overlay, "paths of all variants in one panel, with a legend");
    plot->add_flag("--film", options.film, "film of the beads, or of the rods, too");
    add_dry_run(*plot, options);
    add_quiet(*plot, options);
    CLI::App* info =
        add_verb(app, options, Verb::info, "info", "versions and CPU; or what a result file holds",
                 "  rodwake info\n"
                 "  rodwake info results/quickstart/result.h5\n"
                 "  rodwake info results/phase_perpendicular/scan.csv");
    info->add_option("FILE", options.target, "result file or run directory");
    info->add_flag("--scene-reference", options.scene_reference,
                   "print docs/scene.md: every key a scene may have");
    info->add_flag("--figure-reference", options.figure_reference,
                   "print docs/figures.md: the kinds of figures and what each needs");
    info->add_flag("--file-reference", options.file_reference,
                   "print docs/files.md: the files of a run and their columns");
    info->add_flag("--schema", options.schema, "print keys, figures and measures as JSON");
    info->add_flag("--man", options.man, "print the manual page");
    info->add_option("--completion", options.completion, "print the script that completes command lines")
        ->check(one_of({"bash", "zsh"}));
}

} // namespace

void define_command_line(CLI::App& app, Options& options) {
    app.set_version_flag("-V,--version", "rodwake " + build_info().version);
    app.footer("Start with:  rodwake scenes, or rodwake new\nHelp on a command:  rodwake help run; on a key "
               "or a column:  rodwake help coupling.kappa\n" +
               std::string(exit_codes));
    app.require_subcommand(0, 1);
    add_verbs(app, options);
    CLI::App* help = add_verb(app, options, Verb::help, "help",
                              "explain a command, a key of scenes, a result file or one of its columns",
                              "  rodwake help run\n"
                              "  rodwake help coupling.kappa\n"
                              "  rodwake help '[scan]'\n"
                              "  rodwake help scan.csv\n"
                              "  rodwake help mean_speed0");
    help->add_option("NAME", options.target,
                     "command, table or key of a scene, result file, column or value; without it, all "
                     "commands are listed");
}

std::vector<std::string> option_names(const CLI::Option& option) {
    std::vector<std::string> names;
    for (const std::string& name : option.get_snames())
        names.push_back("-" + name);
    for (const std::string& name : option.get_lnames())
        names.push_back("--" + name);
    return names;
}

std::vector<std::string> option_names(const CLI::App& verb) {
    std::vector<std::string> all;
    for (const CLI::Option* option : verb.get_options())
        std::ranges::copy(option_names(*option), std::back_inserter(all));
    return all;
}

bool takes_value(const CLI::Option& option) { return option.get_items_expected_max() > 0; }

std::string exit_codes_text() { return exit_codes; }

} // namespace rodwake::cli
