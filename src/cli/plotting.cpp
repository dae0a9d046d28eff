#include "rodwake/core/error.hpp"
#include "stages.hpp"

#include <sys/wait.h>
#include <unistd.h>

#include <spawn.h>
#include <vector>

extern char** environ;

namespace rodwake::cli {

namespace {

namespace fs = std::filesystem;

/// plots/ of the installation beside the program, else of the source tree it was built from.
fs::path plotting_program() {
    std::error_code error;
    const fs::path program = fs::read_symlink("/proc/self/exe", error);
    const fs::path installed =
        program.parent_path().parent_path() / "share" / "rodwake" / "plots" / "rodwake_plot.py";
    if (!error && fs::exists(installed, error))
        return installed;
    return fs::path(RODWAKE_SOURCE_PLOTS) / "rodwake_plot.py";
}

int run(const std::vector<std::string>& command) {
    std::vector<char*> arguments;
    for (const std::string& word : command)
        arguments.push_back(
            const_cast<char*>(word.c_str())); // posix_spawn takes char* and does not write through it
    arguments.push_back(nullptr);
    pid_t child = 0;
    if (::posix_spawn(&child, arguments[0], nullptr, nullptr, arguments.data(), environ) != 0)
        throw RunError(command[0] + ": cannot be run; figures need python3 with matplotlib and h5py "
                                    "(tools/quickstart --deps-only installs them)");
    int status = 0;
    ::waitpid(child, &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : 1;
}

} // namespace

void make_figures(const fs::path& run_directory, bool pdf, bool quiet) {
    std::vector<std::string> command = {RODWAKE_PYTHON, plotting_program().string(), run_directory.string()};
    if (pdf)
        command.emplace_back("--pdf");
    if (quiet)
        command.emplace_back("--quiet");
    if (run(command) != 0)
        throw RunError("the figures could not be made (see above); the results themselves are in " +
                       run_directory.string());
}

} // namespace rodwake::cli
