#include "log.hpp"

#include "rodwake/core/error.hpp"

#include <spdlog/pattern_formatter.h>
#include <spdlog/sinks/basic_file_sink.h>
#include <spdlog/sinks/stdout_color_sinks.h>

#include <nlohmann/json.hpp>

namespace rodwake::cli {

namespace {

/// %J: the message as a JSON string, escaped.
class JsonPayload : public spdlog::custom_flag_formatter {
public:
    void format(const spdlog::details::log_msg& message, const std::tm&, spdlog::memory_buf_t& out) override {
        const std::string_view payload(message.payload.data(), message.payload.size());
        const std::string text =
            nlohmann::json(payload).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
        out.append(text.data(), text.data() + text.size());
    }
    std::unique_ptr<custom_flag_formatter> clone() const override { return std::make_unique<JsonPayload>(); }
};

spdlog::sink_ptr file_sink(const std::filesystem::path& path, bool truncate) {
    try {
        return std::make_shared<spdlog::sinks::basic_file_sink_mt>(path.string(), truncate);
    } catch (const spdlog::spdlog_ex& error) {
        throw RunError(path.string() + ": cannot write the log: " + error.what());
    }
}

spdlog::sink_ptr json_sink(const std::filesystem::path& path) {
    auto sink = file_sink(path, false);
    auto formatter = std::make_unique<spdlog::pattern_formatter>();
    formatter->add_flag<JsonPayload>('J').set_pattern(
        R"({"time":"%Y-%m-%dT%H:%M:%S.%e%z","level":"%l","message":%J})");
    sink->set_formatter(std::move(formatter));
    return sink;
}

} // namespace

Logger make_logger(const Options& options, const std::filesystem::path& run_log) {
    auto terminal = std::make_shared<spdlog::sinks::stderr_color_sink_mt>();
    terminal->set_pattern("%v");
    terminal->set_level(options.quiet ? spdlog::level::err
                                      : (options.verbose ? spdlog::level::debug : spdlog::level::info));
    auto logger = std::make_shared<spdlog::logger>("rodwake", terminal);
    logger->set_level(spdlog::level::debug);
    logger->flush_on(spdlog::level::info);
    if (!run_log.empty()) {
        auto sink = file_sink(run_log, false);
        sink->set_pattern("%Y-%m-%d %H:%M:%S.%e %l: %v");
        logger->sinks().push_back(sink);
    }
    if (!options.json_log.empty())
        logger->sinks().push_back(json_sink(options.json_log));
    return logger;
}

} // namespace rodwake::cli
