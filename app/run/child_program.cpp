#include "rodwake/app/child_program.hpp"

#include "rodwake/core/error.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>

extern char** environ;

namespace rodwake::app {

namespace {

/// One end of it is closed when the child has the other, or never came to be.
struct Pipe {
    std::array<int, 2> end{-1, -1};

    Pipe() {
        if (::pipe2(end.data(), O_CLOEXEC) != 0)
            throw RunError(fmt::format("no pipe to another program: {}", std::strerror(errno)));
    }
    ~Pipe() {
        close(0);
        close(1);
    }
    Pipe(const Pipe&) = delete;
    Pipe& operator=(const Pipe&) = delete;

    void close(std::size_t which) {
        if (end[which] >= 0)
            ::close(end[which]);
        end[which] = -1;
    }

    /// Appends what there is; closes the end at which there is no more.
    void read_into(std::string& text) {
        std::array<char, 65536> some{};
        const ssize_t got = ::read(end[0], some.data(), some.size());
        if (got > 0)
            text.append(some.data(), static_cast<std::size_t>(got));
        else if (got == 0 || errno != EINTR)
            close(0);
    }
};

pid_t start(const std::vector<std::string>& command, const std::string& needs, const Pipe* out,
            const Pipe* error) {
    std::vector<char*> arguments;
    arguments.reserve(command.size() + 1);
    for (const std::string& word : command) // posix_spawn takes char* and does not write through it
        arguments.push_back(const_cast<char*>(word.c_str()));
    arguments.push_back(nullptr);
    posix_spawn_file_actions_t actions;
    ::posix_spawn_file_actions_init(&actions);
    if (out) {
        ::posix_spawn_file_actions_adddup2(&actions, out->end[1], STDOUT_FILENO);
        ::posix_spawn_file_actions_adddup2(&actions, error->end[1], STDERR_FILENO);
    }
    pid_t child = 0;
    const int failed = ::posix_spawnp(&child, arguments[0], &actions, nullptr, arguments.data(), environ);
    ::posix_spawn_file_actions_destroy(&actions);
    if (failed != 0)
        throw RunError(fmt::format("{}: cannot be run ({}); {}", command[0], std::strerror(failed), needs));
    return child;
}

} // namespace

ChildEnd run_child(const std::vector<std::string>& command, const std::string& needs,
                   const std::function<bool()>& stopped,
                   const std::function<void(const std::string& line)>& on_line) {
    ChildEnd ended;
    std::optional<Pipe> out, error;
    if (on_line) {
        out.emplace();
        error.emplace();
    }
    const pid_t child = start(command, needs, on_line ? &*out : nullptr, on_line ? &*error : nullptr);

    // Listens until both streams end. A child may close them and live on, so its end is waited for, too.
    std::string text;
    if (on_line) {
        out->close(1);
        error->close(1);
        while (out->end[0] >= 0 || error->end[0] >= 0) {
            std::array<pollfd, 2> waiting{pollfd{out->end[0], POLLIN, 0}, pollfd{error->end[0], POLLIN, 0}};
            ::poll(waiting.data(), waiting.size(), 50);
            if (stopped && stopped())
                ::kill(child, SIGTERM);
            if (waiting[0].revents != 0)
                out->read_into(text);
            if (waiting[1].revents != 0)
                error->read_into(ended.error);
            for (std::size_t end = text.find('\n'); end != text.npos; end = text.find('\n')) {
                on_line(text.substr(0, end));
                text.erase(0, end + 1);
            }
        }
    }

    int status = 0;
    for (pid_t found = 0; found != child; found = ::waitpid(child, &status, WNOHANG)) {
        if (found < 0 && errno != EINTR)
            throw RunError(
                fmt::format("{}: how it ended is not known: {}", command[0], std::strerror(errno)));
        if (stopped && stopped())
            ::kill(child, SIGTERM);
        ::poll(nullptr, 0, 10);
    }
    ended.code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    return ended;
}

} // namespace rodwake::app
