// rodwake tradeoff, design and camera: Python carries them out (commands/rodwake_commands) with the options
// that are described and checked here.

#include "rodwake/app/child_program.hpp"
#include "terminal.hpp"
#include "verbs.hpp"

#include <fmt/format.h>

#include <filesystem>

namespace rodwake::cli {

int verb_python(const Options& options, const std::string& name) {
    const std::string program = std::filesystem::read_symlink("/proc/self/exe").string();
    std::vector<std::string> command = {
        RODWAKE_FIGURES_PYTHON, (shipped_folder() / "commands" / "rodwake_commands").string(), program, name};
    const auto give = [&](const std::string& option, const std::string& value) {
        if (!value.empty())
            command.push_back(option + "=" + value);
    };

    // Words NAME=VALUE, which have no dash that Python could mistake for an option.
    give("target", options.target);
    give("command", options.command);
    give("output", name == "camera" ? options.output : output_folder(options).string());
    for (const std::string& setting : options.overrides)
        give("set", setting);
    for (const std::string& values : options.vary)
        give("vary", values);
    for (const auto& [option, value] : options.answers)
        give(option, value);
    if (options.threads > 0)
        give("threads", fmt::format("{}", options.threads));
    if (options.seed)
        give("seed", fmt::format("{}", *options.seed));
    give("log_json", options.json_log);
    for (const auto& [flag, is_set] : {std::pair{"force", options.force},
                                       {"dry_run", options.dry_run},
                                       {"quiet", options.quiet},
                                       {"verbose", options.verbose}})
        give(flag, is_set ? "1" : "");

    const app::ChildEnd end = app::run_child(command,
                                             "rodwake " + name +
                                                 " needs python3 with numpy, h5py and matplotlib "
                                                 "(tools/quickstart --deps-only)",
                                             [] { return stop_signal() != 0; });
    return stop_signal() ? signal_exit_code(stop_signal()) : end.code;
}

} // namespace rodwake::cli
