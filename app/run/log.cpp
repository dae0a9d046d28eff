#include "log.hpp"

#include "rodwake/core/error.hpp"
#include "rodwake/core/spelling.hpp"

#include <spdlog/pattern_formatter.h>
#include <spdlog/sinks/base_sink.h>
#include <spdlog/sinks/basic_file_sink.h>

#include <mutex>

namespace rodwake::app {

namespace {

class CallerSink : public spdlog::sinks::base_sink<std::mutex> {
public:
    explicit CallerSink(std::function<void(Severity, const std::string&)> log) : log_(std::move(log)) {}

private:
    void sink_it_(const spdlog::details::log_msg& message) override {
        using spdlog::level::level_enum;
        const Severity severity = message.level <= level_enum::debug  ? Severity::debug
                                  : message.level == level_enum::info ? Severity::info
                                  : message.level == level_enum::warn ? Severity::warning
                                                                      : Severity::error;
        log_(severity, printable({message.payload.data(), message.payload.size()}));
    }
    void flush_() override {}

    std::function<void(Severity, const std::string&)> log_;
};

/// %P: the message in UTF-8, whatever names of files it quotes.
class PrintablePayload : public spdlog::custom_flag_formatter {
public:
    void format(const spdlog::details::log_msg& message, const std::tm&, spdlog::memory_buf_t& out) override {
        const std::string text = printable({message.payload.data(), message.payload.size()});
        out.append(text.data(), text.data() + text.size());
    }
    std::unique_ptr<custom_flag_formatter> clone() const override {
        return std::make_unique<PrintablePayload>();
    }
};

} // namespace

Logger make_logger(const RunContext& context, const std::filesystem::path& run_log) {
    auto logger = std::make_shared<spdlog::logger>("rodwake");
    try {
        auto sink = std::make_shared<spdlog::sinks::basic_file_sink_mt>(run_log.string(), false);
        auto formatter = std::make_unique<spdlog::pattern_formatter>();
        formatter->add_flag<PrintablePayload>('P').set_pattern("%Y-%m-%d %H:%M:%S.%e %l: %P");
        sink->set_formatter(std::move(formatter));
        logger->sinks().push_back(std::move(sink));
    } catch (const spdlog::spdlog_ex& error) {
        throw RunError(run_log.string() + ": cannot write the log: " + error.what());
    }
    logger->set_level(spdlog::level::debug);
    logger->flush_on(spdlog::level::info);
    if (context.log)
        logger->sinks().push_back(std::make_shared<CallerSink>(context.log));
    return logger;
}

Logger make_silent_logger() { return std::make_shared<spdlog::logger>("rodwake"); }

} // namespace rodwake::app
