#include "log.hpp"

#include "rodwake/core/error.hpp"

#include <spdlog/sinks/base_sink.h>
#include <spdlog/sinks/basic_file_sink.h>

#include <mutex>

namespace rodwake::app {

namespace {

Severity severity(spdlog::level::level_enum level) {
    switch (level) {
    case spdlog::level::trace:
    case spdlog::level::debug:
        return Severity::debug;
    case spdlog::level::info:
        return Severity::info;
    case spdlog::level::warn:
        return Severity::warning;
    default:
        return Severity::error;
    }
}

class CallerSink : public spdlog::sinks::base_sink<std::mutex> {
public:
    explicit CallerSink(std::function<void(Severity, const std::string&)> log) : log_(std::move(log)) {}

private:
    void sink_it_(const spdlog::details::log_msg& message) override {
        log_(severity(message.level), std::string(message.payload.data(), message.payload.size()));
    }
    void flush_() override {}

    std::function<void(Severity, const std::string&)> log_;
};

spdlog::sink_ptr file_sink(const std::filesystem::path& path) {
    try {
        auto sink = std::make_shared<spdlog::sinks::basic_file_sink_mt>(path.string(), false);
        sink->set_pattern("%Y-%m-%d %H:%M:%S.%e %l: %v");
        return sink;
    } catch (const spdlog::spdlog_ex& error) {
        throw RunError(path.string() + ": cannot write the log: " + error.what());
    }
}

} // namespace

Logger make_logger(const RunContext& context, const std::filesystem::path& run_log) {
    auto logger = std::make_shared<spdlog::logger>("rodwake", file_sink(run_log));
    logger->set_level(spdlog::level::debug);
    logger->flush_on(spdlog::level::info);
    if (context.log)
        logger->sinks().push_back(std::make_shared<CallerSink>(context.log));
    return logger;
}

Logger make_silent_logger() { return std::make_shared<spdlog::logger>("rodwake"); }

} // namespace rodwake::app
