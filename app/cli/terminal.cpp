#include "terminal.hpp"

#include "rodwake/core/error.hpp"
#include "rodwake/core/json_text.hpp"
#include "rodwake/core/spelling.hpp"
#include "verbs.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <spdlog/logger.h>
#include <spdlog/pattern_formatter.h>
#include <spdlog/sinks/basic_file_sink.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <exception>
#include <mutex>
#include <new>
#include <string_view>

namespace rodwake::cli {

namespace {

using namespace std::chrono_literals;
using app::Severity;
constexpr std::chrono::milliseconds terminal_interval = 200ms, plain_interval = 10s;

spdlog::level::level_enum level(Severity severity) {
    switch (severity) {
    case Severity::debug:
        return spdlog::level::debug;
    case Severity::info:
        return spdlog::level::info;
    case Severity::warning:
        return spdlog::level::warn;
    case Severity::error:
        break;
    }
    return spdlog::level::err;
}

/// %J: the message as a JSON string, escaped.
class JsonPayload : public spdlog::custom_flag_formatter {
public:
    void format(const spdlog::details::log_msg& message, const std::tm&, spdlog::memory_buf_t& out) override {
        const std::string_view payload(message.payload.data(), message.payload.size());
        const std::string text = json_text(nlohmann::json(payload));
        out.append(text.data(), text.data() + text.size());
    }
    std::unique_ptr<custom_flag_formatter> clone() const override { return std::make_unique<JsonPayload>(); }
};

spdlog::logger make_logger(const Options& options) {
    auto terminal = std::make_shared<spdlog::sinks::stderr_color_sink_mt>();
    terminal->set_pattern("%v");
    terminal->set_level(options.quiet     ? spdlog::level::err
                        : options.verbose ? spdlog::level::debug
                                          : spdlog::level::info);
    spdlog::logger logger("rodwake", terminal);
    if (!options.json_log.empty())
        try {
            auto sink = std::make_shared<spdlog::sinks::basic_file_sink_mt>(options.json_log, false);
            auto formatter = std::make_unique<spdlog::pattern_formatter>();
            formatter->add_flag<JsonPayload>('J').set_pattern(
                R"({"time":"%Y-%m-%dT%H:%M:%S.%e%z","level":"%l","message":%J})");
            sink->set_formatter(std::move(formatter));
            logger.sinks().push_back(std::move(sink));
        } catch (const spdlog::spdlog_ex& error) {
            throw RunError(options.json_log + ": cannot write the log: " + error.what());
        }
    logger.set_level(spdlog::level::debug);
    logger.flush_on(spdlog::level::info);
    return logger;
}

/// The messages of a run, and under them its progress: a line that redraws itself on a terminal, a plain line
/// now and then elsewhere.
class Screen {
public:
    explicit Screen(const Options& options)
        : logger_(make_logger(options)), quiet_(options.quiet), terminal_(::isatty(STDERR_FILENO) == 1) {}
    ~Screen() { wipe(); }
    Screen(const Screen&) = delete;
    Screen& operator=(const Screen&) = delete;
    Screen(Screen&&) = delete;
    Screen& operator=(Screen&&) = delete;

    void log(Severity severity, const std::string& message) {
        const std::lock_guard lock(mutex_);
        wipe();
        logger_.log(level(severity), printable(message));
    }

    void progress(const app::ProgressReport& report) {
        if (quiet_)
            return;
        const auto now = Clock::now();
        if (report.what != what_ || report.value < last_) { // another task
            what_ = report.what;
            start_ = now;
            next_ = now + interval();
        }
        last_ = report.value;
        if (now < next_)
            return;
        next_ = now + interval();
        const double seconds = std::chrono::duration<double>(now - start_).count(),
                     rate = (report.value - report.begin) / seconds,
                     left = rate > 0.0 ? (report.end - report.value) / rate : 0.0;
        const std::string line = fmt::format("{}: {:.4g} of {:.4g} {} ({:.0f} %), {:.3g} {}/s, {:.0f} s left",
                                             report.what, report.value, report.end, report.unit,
                                             100.0 * report.value / report.end, rate, report.unit, left);
        const std::lock_guard lock(mutex_);
        if (!terminal_)
            return logger_.info(line);
        draw("\r\033[K" + line);
        drawn_ = true;
    }

private:
    using Clock = std::chrono::steady_clock;
    std::chrono::milliseconds interval() const { return terminal_ ? terminal_interval : plain_interval; }

    static void draw(const std::string& text) {
        std::fwrite(text.data(), 1, text.size(), stderr);
        std::fflush(stderr);
    }

    void wipe() {
        if (drawn_)
            draw("\r\033[K");
        drawn_ = false;
    }

    spdlog::logger logger_;
    bool quiet_, terminal_, drawn_ = false;
    std::string what_;
    double last_ = 0.0;
    Clock::time_point start_, next_;
    std::mutex mutex_;
};

} // namespace

void print_message(const std::string& text) {
    const std::string line = printable(text);
    std::fwrite(line.data(), 1, line.size(), stderr);
}

void end_well_without_memory() {
    std::set_terminate([] {
        const auto end = [](std::string_view message) {
            [[maybe_unused]] const auto written = ::write(STDERR_FILENO, message.data(), message.size());
            std::_Exit(1);
        };
        try {
            if (const auto error = std::current_exception())
                std::rethrow_exception(error);
            if (std::uncaught_exceptions() > 0) // it would have left a function that may not throw
                end("rodwake: not enough memory, or an unknown error in a library\n");
        } catch (const std::bad_alloc&) {
            end("rodwake: not enough memory\n");
        } catch (...) { // a defect: abort tells more
        }
        std::abort();
    });
}

void open_standard_streams() {
    for (int stream = STDIN_FILENO; stream <= STDERR_FILENO; ++stream)
        if (::fcntl(stream, F_GETFD) < 0 && errno == EBADF)
            ::open("/dev/null", O_RDWR); // takes the lowest number that is free: this one
}

app::RunContext context_of(const Options& options) {
    const auto screen = std::make_shared<Screen>(options);
    app::RunContext context;
    context.threads = options.threads;
    context.seed = options.seed;
    context.force = options.force;
    context.command = options.command;
    context.log = [screen](Severity severity, const std::string& message) { screen->log(severity, message); };
    context.progress = [screen](const app::ProgressReport& report) { screen->progress(report); };
    context.converter = {RODWAKE_FIGURES_PYTHON, (shipped_folder() / "convert" / "rodwake_convert").string()};
    context.stop = [] { return stop_signal() != 0; };
    context.checkpoint_requests = checkpoint_requests;
    context.scan.part = part_of(options).value_or(scan::Part{});
    context.scan.merge = options.merge;
    context.scan.rerun_failed = options.rerun_failed;
    return context;
}

namespace {

// A handler can reach nothing but globals; these are the only ones.
volatile std::sig_atomic_t requested = 0;
volatile std::sig_atomic_t checkpoint_requested = 0; // how often
volatile std::time_t requested_at = 0;

/// A second signal ends the program at once, but not within a second of the first: terminals and `timeout`
/// signal both a program and its group.
void request_stop(int signal) {
    const std::time_t now = std::time(nullptr); // async-signal-safe
    if (requested && now - requested_at > 1)
        std::_Exit(signal_exit_code(signal));
    if (!requested)
        requested_at = now;
    requested = signal;
}

void request_checkpoint(int) { checkpoint_requested = checkpoint_requested + 1; }

} // namespace

void install_signal_handlers() {
    std::signal(SIGINT, request_stop);
    std::signal(SIGTERM, request_stop);
    std::signal(SIGUSR1, request_checkpoint);
    std::signal(SIGCHLD, SIG_DFL); // whoever started us may ignore it, and then no child tells how it ended
    std::signal(SIGXFSZ, SIG_IGN); // a write beyond the limit fails and says so
}

int checkpoint_requests() { return checkpoint_requested; }

int stop_signal() { return requested; }

int signal_exit_code(int signal) { return 128 + signal; }

} // namespace rodwake::cli
