#pragma once
// A disk that is full: files of a child process cannot grow beyond some size (EFBIG). ENOSPC:
// tests/cli/test_faults.py.

#include "rodwake/core/error.hpp"

#include <csignal>
#include <cstdio>
#include <string>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

namespace store_test {

namespace small_disk_detail {

template<class Work>
std::string outcome(Work work) {
    try {
        work();
        return "done";
    } catch (const rodwake::RunError& error) {
        return error.what();
    } catch (const std::exception& error) {
        return std::string("another error: ") + error.what();
    }
}

template<class Work>
[[noreturn]] void child(int out, rlim_t bytes, Work work) {
    // Catch2's handlers would report the child's end as a failure of the test.
    std::signal(SIGABRT, SIG_DFL);
    std::signal(SIGSEGV, SIG_DFL);
    std::signal(SIGXFSZ, SIG_IGN); // writes fail with EFBIG instead
    const rlimit limit{bytes, bytes};
    ::setrlimit(RLIMIT_FSIZE, &limit);
    const std::string text = outcome(work);
    [[maybe_unused]] const auto written = ::write(out, text.data(), text.size());
    ::_exit(0);
}

} // namespace small_disk_detail

/// Does the work in a child process whose files cannot grow beyond `bytes`: "done", the text of the RunError,
/// "another error: ...", or "signal <n>" if it crashed.
template<class Work>
std::string on_small_disk(rlim_t bytes, Work work) {
    int ends[2];
    if (::pipe(ends) != 0)
        return "no pipe";
    std::fflush(nullptr);
    const pid_t pid = ::fork();
    if (pid == 0)
        small_disk_detail::child(ends[1], bytes, work);
    ::close(ends[1]);
    std::string text;
    char part[256];
    for (ssize_t got = 0; (got = ::read(ends[0], part, sizeof part)) > 0;)
        text.append(part, static_cast<std::size_t>(got));
    ::close(ends[0]);
    int status = 0;
    ::waitpid(pid, &status, 0);
    return WIFSIGNALED(status) ? "signal " + std::to_string(WTERMSIG(status)) : text;
}

} // namespace store_test
