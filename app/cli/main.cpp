#include "options.hpp"
#include "rodwake/app/run_folder.hpp"
#include "rodwake/core/error.hpp"
#include "terminal.hpp"
#include "verbs.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <exception>

namespace rodwake::cli {

namespace {

int dispatch(const Options& options) {
    switch (options.verb) {
    case Verb::scenes:
        return verb_scenes(options);
    case Verb::new_scene:
        return verb_new(options);
    case Verb::check:
        return verb_check(options);
    case Verb::field:
        return options.points.empty() ? verb_stages(options) : verb_field_points(options);
    case Verb::rods:
    case Verb::dem:
    case Verb::measure:
    case Verb::fit:
    case Verb::scan:
    case Verb::run:
        return verb_stages(options);
    case Verb::impact:
        return verb_impact(options);
    case Verb::tradeoff:
        return verb_python(options, "tradeoff");
    case Verb::design:
        return verb_python(options, "design");
    case Verb::camera:
        return verb_python(options, "camera");
    case Verb::convert:
        return verb_convert(options);
    case Verb::replay:
        return verb_replay(options);
    case Verb::explore:
        return verb_explore(options);
    case Verb::plot:
        return verb_plot(options);
    case Verb::info:
        return verb_info(options);
    case Verb::help: // on a verb: its line is turned into one with --help
        return verb_help(options);
    }
    return 2;
}

int fail(const std::exception& error, int code) {
    print_message(fmt::format("rodwake: {}\n", describe(error)));
    return code;
}

} // namespace

} // namespace rodwake::cli

int main(int argc, char** argv) {
    using namespace rodwake::cli;
    open_standard_streams();
    end_well_without_memory();
    const Parsed parsed = parse_command_line(argc, argv);
    install_signal_handlers();
    try {
        const int code = parsed.exit_now ? parsed.exit_code : dispatch(parsed.options);
        // Output of a verb may still be in the buffer: a full disk shows here.
        if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0)
            throw rodwake::RunError("cannot write to standard output");
        return code;
    } catch (const rodwake::app::FinishedRun& finished) {
        return fail(finished, 0);
    } catch (const rodwake::InputError& error) {
        return fail(error, 2);
    } catch (const std::exception& error) {
        return fail(error, 1);
    }
}
