#include "options.hpp"

#include "rodwake/core/build_info.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
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
    verb.add_option("--seed", options.seed, "seed of everything random, 0 to 2^63 - 1")
        ->check(CLI::Range(std::uint64_t{0}, largest_seed));
}

void add_quiet(CLI::App& verb, Options& options) {
    verb.add_flag("--quiet", options.quiet, "no progress, no summary; errors only");
}

void add_dry_run(CLI::App& verb, Options& options) {
    verb.add_flag("--dry-run", options.dry_run, "say what would be done, do nothing");
}

void add_run(CLI::App& verb, Options& options) {
    verb.add_option("-j,--threads", options.threads, "threads [one for each core]")
        ->check(CLI::Range(1, 1024));
    verb.add_flag("--force", options.force, "replace a finished run");
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

void add_stage_verb(CLI::App& app, Options& options, Verb verb, const std::string& name,
                    const std::string& does, const std::string& examples) {
    CLI::App* sub = add_verb(app, options, verb, name, does, examples);
    add_scene(*sub, options);
    add_run(*sub, options);
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
        ->check(CLI::IsMember({"exact", "table"}));
    field->add_option("--table-tolerance", options.table_tolerance, "relative error of tables, 1e-12 to 0.1")
        ->check(CLI::Range(1e-12, 0.1));
}

void add_scan(CLI::App& app, Options& options) {
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
                   "take over what the shares below -o hold, evaluate what is missing, write the results")
        ->excludes("--part");
    scan->add_flag("--rerun-failed", options.rerun_failed, "evaluate points again that failed");
}

/// "5ms" and "5 ms" are 0.005.
CLI::AsNumberWithUnit seconds() {
    return CLI::AsNumberWithUnit(
        std::map<std::string, double>{{"us", 1e-6}, {"ms", 1e-3}, {"s", 1.0}, {"min", 60.0}, {"h", 3600.0}},
        CLI::AsNumberWithUnit::CASE_SENSITIVE, "TIME");
}

void add_tradeoff(CLI::App& app, Options& options) {
    CLI::App* tradeoff =
        add_verb(app, options, Verb::tradeoff, "tradeoff",
                 "time and error of every way to solve a scene, or one part of it; the cheapest for an error",
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
        ->add_option("--of", options.tradeoff_of,
                     "rods (or their scan), bed, fit or field [the first of these in the scene]")
        ->check(CLI::IsMember({"rods", "bed", "fit", "field"}));
    CLI::Option* error = tradeoff->add_option(
        "--for", options.want_error,
        "print the cheapest setting whose error is at most this, as keys of the scene: 1e-6; of a bed 2% or "
        "\"T_xy 1%\"");
    tradeoff
        ->add_option("--within", options.want_time,
                     "print the most accurate setting that takes at most this: 5ms, 2s, 1min")
        ->transform(seconds())
        ->check(CLI::PositiveNumber)
        ->excludes(error);
    tradeoff
        ->add_option(
            "--error", options.error_kind,
            "of what: of rods final_state, contact_time, outcome (share that differs) or path (at all output "
            "times); of a bed rod_speed, T_xy, T_z, psi6, wake, ...; of a fit optimum, interval or "
            "objective; of a "
            "field displacement, strain or gradients [the first]")
        ->option_text("KIND");
    tradeoff
        ->add_option(
            "--limit", options.limit,
            "give up a setting that takes longer; of a bed the CPU time each setting is measured for "
            "[60s]")
        ->transform(seconds())
        ->check(CLI::PositiveNumber);
}

void add_stage_verbs(CLI::App& app, Options& options) {
    add_stage_verb(app, options, Verb::rods, "rods", "integrate the rods of a scene",
                   "  rodwake rods scenes/pair.toml -o results/pair\n"
                   "  rodwake rods scenes/pair.toml -s coupling.kappa=100 -s rods_run.method=bdf");
    add_stage_verb(app, options, Verb::dem, "dem",
                   "granular run of a scene; the same command resumes one that was stopped",
                   "  rodwake dem scenes/granular_quick.toml\n"
                   "  rodwake dem scenes/pair_crystal.toml -s granular.phi_b=0.70 -s granular.runs=50 -j 2 "
                   "-o results/fluid");
    add_stage_verb(
        app, options, Verb::measure, "measure",
        "what [measure] names, of the granular run in the results folder or of measure.trajectory; what "
        "[rods_order] names, of the rods there",
        "  rodwake measure scenes/wake.toml\n"
        "  rodwake measure scenes/wake.toml -s measure.displacement=lagrangian --force\n"
        "  rodwake measure scenes/wake.toml -s measure.trajectory=other/trajectory.h5md -o results/other\n"
        "  rodwake measure scenes/crowd.toml -s rods_order.link=1 --force");
    add_stage_verb(app, options, Verb::fit, "fit",
                   "elastic parameters and couplings from measured profiles and tracks, with their errors",
                   "  rodwake fit fitting/problems/monopole.toml -o results/monopole\n"
                   "  rodwake fit scenes/quickstart.toml -s fit.starts=50 -j 2 --force");
    add_scan(app, options);
    add_tradeoff(app, options);
    add_stage_verb(app, options, Verb::run, "run",
                   "every stage the scene names, then figures and report.html",
                   "  rodwake run scenes/quickstart.toml\n"
                   "  rodwake run scenes/attraction.toml -o results/attraction --force");
}

void add_verbs(CLI::App& app, Options& options) {
    CLI::App* check =
        add_verb(app, options, Verb::check, "check",
                 "validate a scene; say what will be modelled and what not, and what each part will cost",
                 "  rodwake check scenes/quickstart.toml\n"
                 "  rodwake check scenes/pair.toml -s coupling.kappa=100\n"
                 "  rodwake check scenes/pair.toml --quiet && echo valid");
    add_scene(*check, options);
    check->add_flag("--quiet", options.quiet, "validate only: errors are printed, nothing is timed");
    add_field(app, options);
    add_stage_verbs(app, options);
    CLI::App* impact =
        add_verb(app, options, Verb::impact, "impact", "single impacts, one a row: the contact law by itself",
                 "  rodwake impact --cases cases.csv > impacts.csv");
    impact
        ->add_option("--cases", options.cases,
                     "CSV with columns Kxx,Kxy,Kxz,Kyy,Kyz,Kzz,vx,vy,vz,mu,e (- for standard input); "
                     "Px,Py,Pz,wx,wy,wz go to standard output")
        ->required();
    add_dry_run(*impact, options);
    CLI::App* plot =
        add_verb(app, options, Verb::plot, "plot", "figures and report from the results of a run",
                 "  rodwake plot results/quickstart --pdf\n"
                 "  rodwake plot results/pair --width column --style paper --film");
    plot->add_option("RESULT", options.target, "run directory, or its result.h5")->required();
    plot->add_flag("--pdf", options.pdf, "PDF beside each PNG");
    plot->add_option(
        "--width", options.figure_width,
        "width of figures: column, page, or a length such as 86mm; several panels take two columns");
    plot->add_option("--style", options.figure_style,
                     "paper (the default), slides, or a matplotlib style file");
    plot->add_flag("--film", options.film, "film of the beads, or of the rods, too");
    add_dry_run(*plot, options);
    add_quiet(*plot, options);
    CLI::App* info =
        add_verb(app, options, Verb::info, "info", "versions and CPU; or what a result file holds",
                 "  rodwake info\n  rodwake info results/quickstart/result.h5");
    info->add_option("FILE", options.target, "result file or run directory");
    info->add_flag("--scene-reference", options.scene_reference,
                   "print docs/scene.md: every key a scene may have");
    info->add_flag("--schema", options.schema, "print the same as JSON, with the kinds of figures");
}

/// A word as a shell takes it: in single quotes if it has anything a shell would touch.
std::string quoted(const std::string& word) {
    constexpr std::string_view plain =
        "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-+=./:,@%";
    if (!word.empty() && word.find_first_not_of(plain) == std::string::npos)
        return word;
    std::string out = "'";
    for (const char c : word)
        out += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return out + "'";
}

std::string shell_command(int argc, const char* const* argv) {
    std::vector<std::string> words(argv, argv + argc);
    std::ranges::transform(words, words.begin(), quoted);
    return fmt::format("{}", fmt::join(words, " "));
}

/// CLI11 would only say that a verb is missing.
void refuse_unknown_verb(const CLI::App& app, int argc, const char* const* argv) {
    std::vector<std::string> verbs;
    for (const CLI::App* verb : app.get_subcommands({}))
        verbs.push_back(verb->get_name());
    if (argc < 2 || argv[1][0] == '-' || std::ranges::find(verbs, argv[1]) != verbs.end())
        return;
    throw CLI::ValidationError(argv[1], fmt::format("no such verb; legal: {}", fmt::join(verbs, ", ")));
}

/// With --points the answer goes to standard output and no scene takes part: what else is given would be
/// ignored.
void check_field_options(const CLI::App& app, const Options& options) {
    if (options.target.empty() == options.points.empty())
        throw CLI::ValidationError("field", "give either a SCENE or --points FILE");
    const CLI::App& field = *app.get_subcommand("field");
    if (options.points.empty() && field.count("--backend") > 0)
        throw CLI::ValidationError("--backend", "is for --points; a scene says medium.field");
    if (field.count("--table-tolerance") > 0 && options.backend != "table")
        throw CLI::ValidationError("--table-tolerance", "is for --points with --backend table; a scene says "
                                                        "medium.table.tolerance");
    if (!options.points.empty() && !options.output.empty())
        throw CLI::ValidationError(
            "--output", "field --points writes to standard output and makes no folder; use > FILE");
    for (const char* flag : {"--set", "--seed", "--threads", "--force", "--quiet", "--verbose", "--log-json"})
        if (!options.points.empty() && field.count(flag) > 0)
            throw CLI::ValidationError(flag, "field --points makes no use of it");
}

} // namespace

std::optional<scan::Part> part_of(const Options& options) {
    long index = 0, of = 0;
    char end = 0;
    if (options.part.empty())
        return std::nullopt;
    if (std::sscanf(options.part.c_str(), "%ld/%ld%c", &index, &of, &end) != 2 || index < 1 || of < index)
        throw CLI::ValidationError("--part", "expected i/n with 1 <= i <= n, found " + options.part);
    return scan::Part{index - 1, of};
}

std::filesystem::path output_folder(const Options& options) {
    const std::filesystem::path folder =
        options.output.empty()
            ? std::filesystem::path("results") / std::filesystem::path(options.target).stem()
            : std::filesystem::path(options.output);
    const auto part = part_of(options);
    return part ? folder / fmt::format("part-{}-of-{}", part->index + 1, part->of) : folder;
}

Parsed parse_command_line(int argc, const char* const* argv) {
    Parsed parsed;
    parsed.options.command = shell_command(argc, argv);
    CLI::App app("rodwake: motile rods in an elastic medium", "rodwake");
    app.set_version_flag("--version", "rodwake " + build_info().version);
    app.require_subcommand(1);
    app.footer("Start with:  rodwake run scenes/quickstart.toml\nHelp on a verb:  rodwake run --help\n" +
               std::string(exit_codes));
    add_verbs(app, parsed.options);
    try {
        refuse_unknown_verb(app, argc, argv);
        app.parse(argc, argv);
        if (parsed.options.verb == Verb::field)
            check_field_options(app, parsed.options);
        part_of(parsed.options);
    } catch (const CLI::ParseError& error) {
        parsed.exit_now = true;
        parsed.exit_code = app.exit(error) == 0 ? 0 : 2;
    }
    return parsed;
}

} // namespace rodwake::cli
