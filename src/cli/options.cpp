#include "options.hpp"

#include "rodwake/core/build_info.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <algorithm>

namespace rodwake::cli {

namespace {

constexpr const char* exit_codes =
    "Exit codes: 0 ok, 1 runtime failure, 2 usage or scene error, 3 finished with failed points,\n"
    "            130/143 stopped by Ctrl-C/SIGTERM.\n";

constexpr std::uint64_t largest_seed = 9223372036854775807; // 2^63 - 1, the largest integer a scene can hold

void add_common(CLI::App& verb, Options& options) {
    verb.add_option("-o,--output", options.output, "folder for the results [results/<scene name>]");
    verb.add_option("-s,--set", options.overrides, "change a key of the scene: table.key=value; repeatable")
        ->allow_extra_args(false);
    verb.add_option("-j,--threads", options.threads, "threads")->check(CLI::Range(1, 1024));
    verb.add_option("--seed", options.seed, "seed of everything random, 0 to 2^63 - 1")
        ->check(CLI::Range(std::uint64_t{0}, largest_seed));
    verb.add_flag("--dry-run", options.dry_run, "say what would be done, do nothing");
    verb.add_flag("--quiet", options.quiet, "no progress, no summary; errors only");
    verb.add_flag("-v,--verbose", options.verbose, "more detail");
    verb.add_flag("--force", options.force, "replace a finished run");
    verb.add_option("--log-json", options.json_log, "also log to FILE, one JSON object a line");
}

CLI::App* add_verb(CLI::App& app, Options& options, Verb verb, const std::string& name,
                   const std::string& does, const std::string& examples) {
    CLI::App* sub = app.add_subcommand(name, does);
    sub->footer("Examples:\n" + examples + "\n" + exit_codes);
    sub->callback([&options, verb] { options.verb = verb; });
    add_common(*sub, options);
    return sub;
}

void add_verbs(CLI::App& app, Options& options) {
    const auto scene = [&](CLI::App* verb) {
        verb->add_option("SCENE", options.target, "scene file (TOML)")->required();
    };
    scene(add_verb(app, options, Verb::check, "check",
                   "validate a scene; say what will be modelled and what not",
                   "  rodwake check scenes/quickstart.toml\n"
                   "  rodwake check scenes/pair.toml -s coupling.kappa=100"));
    CLI::App* field =
        add_verb(app, options, Verb::field, "field", "field of one rod, at points or on a scene's grid",
                 "  rodwake field --points points.csv > field.csv\n"
                 "  rodwake field scenes/ufield.toml -o results/ufield");
    field->add_option("SCENE", options.target, "scene file with a [field] table");
    field->add_option("--points", options.points,
                      "CSV with columns x,y,xi,eta; the field goes to standard output");
    field->add_option("--backend", options.backend, "evaluation: exact")
        ->check(CLI::IsMember({"exact", "table"}));
    field->add_option("--table-tolerance", options.table_tolerance,
                      "relative error of --backend table, 1e-14 to 0.1 [1e-8]");
    scene(add_verb(app, options, Verb::rods, "rods", "integrate the rods of a scene",
                   "  rodwake rods scenes/pair.toml -o results/pair\n"
                   "  rodwake rods scenes/pair.toml -s coupling.kappa=100 -s rods_run.method=bdf"));
    scene(add_verb(app, options, Verb::dem, "dem",
                   "granular run of a scene; the same command resumes one that was stopped",
                   "  rodwake dem scenes/granular_quick.toml\n"
                   "  rodwake dem scenes/pair_crystal.toml -s granular.phi_b=0.70 -s granular.runs=50 -j 2 "
                   "-o results/fluid"));
    add_verb(app, options, Verb::impact, "impact", "single impacts, one a row: the contact law by itself",
             "  rodwake impact --cases cases.csv > impacts.csv")
        ->add_option("--cases", options.cases,
                     "CSV with columns Kxx,Kxy,Kxz,Kyy,Kyz,Kzz,vx,vy,vz,mu,e; Px,Py,Pz,wx,wy,wz go to "
                     "standard output")
        ->required();
    scene(add_verb(
        app, options, Verb::measure, "measure",
        "what [measure] names, of the granular run in the results folder or of measure.trajectory",
        "  rodwake measure scenes/wake.toml\n"
        "  rodwake measure scenes/wake.toml -s measure.displacement=lagrangian --force\n"
        "  rodwake measure scenes/wake.toml -s measure.trajectory=other/trajectory.h5md -o results/other"));
    scene(add_verb(app, options, Verb::fit, "fit",
                   "elastic parameters and couplings from measured profiles and tracks, with their errors",
                   "  rodwake fit fitting/problems/monopole.toml -o results/monopole\n"
                   "  rodwake fit scenes/quickstart.toml -s fit.starts=50 -j 2 --force"));
    scene(add_verb(app, options, Verb::run, "run",
                   "every stage the scene names, then figures and report.html",
                   "  rodwake run scenes/quickstart.toml\n"
                   "  rodwake run scenes/attraction.toml -o results/attraction --force"));
    CLI::App* plot =
        add_verb(app, options, Verb::plot, "plot", "figures and report from the results of a run",
                 "  rodwake plot results/quickstart --pdf");
    plot->add_option("RESULT", options.target, "run directory, or its result.h5")->required();
    plot->add_flag("--pdf", options.pdf, "PDF beside each PNG");
    CLI::App* info =
        add_verb(app, options, Verb::info, "info", "versions and CPU; or what a result file holds",
                 "  rodwake info\n  rodwake info results/quickstart/result.h5");
    info->add_option("FILE", options.target, "result file or run directory");
    info->add_flag("--scene-reference", options.scene_reference,
                   "print docs/scene.md: every key a scene may have");
}

std::string joined(int argc, const char* const* argv) {
    return fmt::format("{}", fmt::join(argv, argv + argc, " "));
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

void check_field_options(const Options& options) {
    if (options.target.empty() == options.points.empty())
        throw CLI::ValidationError("field", "give either a SCENE or --points FILE");
    if (!(options.table_tolerance >= 1e-14 && options.table_tolerance <= 1e-1)) // CLI::Range lets nan pass
        throw CLI::ValidationError("--table-tolerance",
                                   fmt::format("{}: must be from 1e-14 to 0.1", options.table_tolerance));
    if (!options.points.empty() && !options.output.empty())
        throw CLI::ValidationError(
            "--output", "field --points writes to standard output and makes no folder; use > FILE");
}

void check_impact_options(const Options& options) {
    if (!options.output.empty())
        throw CLI::ValidationError("--output",
                                   "impact writes to standard output and makes no folder; use > FILE");
}

} // namespace

Parsed parse_command_line(int argc, const char* const* argv) {
    Parsed parsed;
    parsed.options.command = joined(argc, argv);
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
            check_field_options(parsed.options);
        if (parsed.options.verb == Verb::impact)
            check_impact_options(parsed.options);
    } catch (const CLI::ParseError& error) {
        parsed.exit_now = true;
        parsed.exit_code = app.exit(error) == 0 ? 0 : 2;
    }
    return parsed;
}

} // namespace rodwake::cli
