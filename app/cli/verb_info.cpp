#include "definition.hpp"
#include "rodwake/app/describe.hpp"
#include "rodwake/app/run.hpp"
#include "rodwake/app/run_folder.hpp"
#include "rodwake/core/build_info.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/core/json_text.hpp"
#include "rodwake/core/spelling.hpp"
#include "rodwake/scan/ledger.hpp"
#include "rodwake/scene/document.hpp"
#include "rodwake/store/csv.hpp"
#include "rodwake/store/hdf5_reader.hpp"
#include "rodwake/store/track_file.hpp"
#include "verbs.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <deque>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <vector>

namespace rodwake::cli {

namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

constexpr std::size_t widest = 160; ///< characters of a line that is shown

std::string cut(const std::string& text, std::size_t width = widest) {
    if (text.size() <= width)
        return text;
    std::size_t end = width;
    while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0U) == 0x80U) // within a UTF-8 character
        --end;
    return text.substr(0, end) + "...";
}

std::ifstream opened(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    if (!in)
        throw InputError(file.string() + ": cannot be read");
    return in;
}

/// What the fields of a column are: numbers from low to high, words, or nothing.
struct ColumnContent {
    double low = HUGE_VAL, high = -HUGE_VAL;
    long numbers = 0, empty = 0;
    std::map<std::string, long> words; ///< the first few that differ, and how often

    void add(std::string_view field) {
        double value = 0.0;
        const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), value);
        if (field.empty()) {
            ++empty;
        } else if (error == std::errc{} && end == field.data() + field.size()) {
            ++numbers;
            low = std::min(low, value);
            high = std::max(high, value);
        } else if (constexpr std::size_t most = 8;
                   words.size() < most || words.contains(std::string(field))) {
            ++words[std::string(field)];
        }
    }

    std::string text() const {
        std::string range = numbers == 0  ? ""
                            : low == high ? fmt::format("{:.6g}", low)
                                          : fmt::format("{:.6g} to {:.6g}", low, high);
        for (const auto& [word, times] : words)
            range += fmt::format("{}{} {}", range.empty() ? "" : ", ", cut(word, 24), times);
        return range + (empty == 0 ? "" : fmt::format("{}{} empty", range.empty() ? "" : ", ", empty));
    }
};

std::string table_text(const fs::path& file) {
    constexpr std::size_t most_columns = 60, ends = 3;
    const std::vector<app::ColumnEntry> names = app::columns_of(file);
    std::vector<ColumnContent> columns(names.size());
    std::vector<std::string> first; // and the header
    std::deque<std::string> last;
    std::size_t rows = 0;
    store::for_each_csv_row(file, [&](std::string_view line, std::span<const std::string> fields) {
        const bool is_header = first.empty();
        for (std::size_t k = 0; !is_header && k < columns.size(); ++k)
            columns[k].add(k < fields.size() ? std::string_view(fields[k]) : "");
        rows += is_header ? 0 : 1;
        if (first.size() <= ends)
            first.push_back(cut(std::string(line)));
        else if (last.push_back(cut(std::string(line))); last.size() > ends)
            last.pop_front();
    });
    std::string text = fmt::format("{} rows, {} columns\n", rows, names.size());
    for (std::size_t k = 0; k < std::min(names.size(), most_columns); ++k)
        text += fmt::format("  {:<24} {:<10} {:<28} {}\n", names[k].name, names[k].unit, columns[k].text(),
                            names[k].meaning);
    if (names.size() > most_columns)
        text += fmt::format("  ... {} more columns\n", names.size() - most_columns);
    text += fmt::format("\n{}\n", fmt::join(first, "\n"));
    if (rows > 2 * ends)
        text += fmt::format("... {} rows ...\n", rows - 2 * ends);
    for (const std::string& name : last)
        text += name + "\n";
    return text;
}

/// Of lists the first and the last entries, of long tables the first.
ordered_json shortened(const ordered_json& value) {
    constexpr std::size_t longest = 6, shown = 3, most_keys = 40;
    ordered_json out = value;
    if (value.is_array() && value.size() > longest) {
        out = ordered_json(value.begin(), value.begin() + shown);
        out.push_back(fmt::format("... {} in all ...", value.size()));
        out.push_back(value.back());
    } else if (value.is_object() && value.size() > most_keys) {
        out = ordered_json::object();
        for (auto item = value.begin(); out.size() < most_keys; ++item)
            out[item.key()] = item.value();
        out["..."] = fmt::format("{} keys in all", value.size());
    }
    if (out.is_structured())
        for (ordered_json& item : out)
            item = shortened(item);
    return out;
}

/// The first and the last lines of a long text.
std::string text_text(std::istream& in) {
    constexpr std::size_t head = 180, tail = 20;
    std::string text;
    std::deque<std::string> last;
    std::size_t lines = 0;
    for (std::string line; std::getline(in, line); ++lines)
        if (lines < head)
            text += cut(line) + "\n";
        else if (last.push_back(cut(line) + "\n"); last.size() > tail)
            last.pop_front();
    if (lines > head + tail)
        text += fmt::format("... {} lines ...\n", lines - head - tail);
    for (const std::string& line : last)
        text += line;
    return text;
}

std::string json_text(const fs::path& file) {
    std::ifstream in = opened(file);
    try {
        std::istringstream text(rodwake::json_text(shortened(ordered_json::parse(in)), 2));
        return text_text(text);
    } catch (const ordered_json::exception& error) {
        throw InputError(fmt::format("{}: not valid JSON: {}", file.string(), error.what()));
    }
}

bool ends_in(const std::string& ending, std::initializer_list<std::string_view> endings) {
    return std::ranges::find(endings, ending) != endings.end();
}

/// By content and name. Throws InputError for a file that cannot be read or is of no known kind.
std::string file_text(const fs::path& file) {
    const std::string ending = file.extension().string();
    std::string start(64, '\0');
    std::ifstream in = opened(file);
    in.read(start.data(), static_cast<std::streamsize>(start.size()));
    start.resize(static_cast<std::size_t>(in.gcount()));
    if (start.empty())
        throw InputError(file.string() + ": is empty");
    if (file.filename() == scan::ledger_file) {
        const scan::Counts counts = scan::counts_of(file);
        std::string text = fmt::format(
            "{} points evaluated, {} of them failed, {:.4g} CPU seconds{}\n", counts.points, counts.failed,
            counts.seconds, fs::exists(file.parent_path() / "scan.json") ? "" : "; the scan has not ended");
        for (const auto& [outcome, points] : counts.outcomes)
            text += fmt::format("  {:>8}  {}\n", points, outcome);
        for (const auto& [cause, points] : counts.causes)
            text += fmt::format("  {:>8}  {}\n", points, cause);
        return text;
    }
    if (start.starts_with("SQLite format 3"))
        throw InputError(file.string() +
                         ": is the ledger of a scan of rodwake 0.3; its points are in scan.csv and scan.h5");
    if (start.starts_with("\x89PNG") || ends_in(ending, {".pdf", ".html", ".gif", ".mp4", ".webm", ".svg"})) {
        // Pictures are to be looked at with another program.
        const std::string what = app::what_of(file);
        return fmt::format("{}; {} bytes; open it with a viewer or a browser\n",
                           what.empty() ? "a figure, page or film" : what, fs::file_size(file));
    }
    if (ending == ".rwc")
        return app::describe_checkpoint(file);
    if (ending == ".csv")
        return table_text(file);
    if (ending == ".json")
        return json_text(file);
    std::ifstream again = opened(file);
    if (ends_in(ending, {".toml", ".txt", ".xyz", ".vti", ".lock"}))
        return text_text(again);
    if (const std::string what = app::what_of(file); ending == ".log" && !what.empty())
        return fmt::format("{}; {} bytes\n", what, fs::file_size(file));
    if (const TrackFormat format = store::track_format(file);
        format != TrackFormat::h5md && format != TrackFormat::csv)
        return fmt::format("tracks in the format {}; {} bytes; rodwake convert FILE -o OUT.csv shows them\n",
                           to_string(format), fs::file_size(file));
    try {
        return store::list_hdf5(file);
    } catch (const InputError& error) {
        throw InputError(fmt::format("{}, and nothing else that info knows: CSV, JSON, TOML and text, "
                                     "checkpoints (.rwc), points.log, figures, a run folder",
                                     error.what()));
    }
}

int describe_run(const fs::path& folder) {
    const std::string status = app::run_status(folder);
    if (status.empty())
        throw InputError(folder.string() + ": holds no rodwake run (no provenance.json)");
    fmt::print("{}: {} run\n", printable(folder.string()), status);
    const std::vector<app::FileEntry> files = app::files_of_run(folder);
    for (const app::FileEntry& file : files)
        fmt::print("  {:<40} {}\n", file.name, file.what);
    for (const app::FileEntry& file : files)
        if (file.name.ends_with(".json") && file.name.find('/') == std::string::npos &&
            file.name != "manifest.json" && !file.progress) {
            fmt::print("\n{}\n", file.name);
            fmt::print("{}", printable(file_text(folder / file.name)));
        }
    if (fs::exists(folder / scan::ledger_file) && !fs::exists(folder / "scan.json"))
        fmt::print("\n{}\n{}", scan::ledger_file, file_text(folder / scan::ledger_file));
    if (fs::exists(folder / "result.h5"))
        fmt::print("\nresult.h5\n{}", store::list_hdf5(folder / "result.h5"));
    return 0;
}

} // namespace

int verb_info(const Options& options) {
    const std::pair<bool, std::string (*)()> references[] = {
        {options.scene_reference, scene::scene_reference},
        {options.figure_reference, scene::figure_reference},
        {options.file_reference, app::file_reference},
        {options.schema, app::schema_json}};
    for (const auto& [wanted, text] : references)
        if (wanted) {
            fmt::print("{}", text());
            return 0;
        }
    if (options.man || !options.completion.empty()) {
        // The manual page or a completion script.
        Options unused;
        CLI::App program("", "rodwake");
        define_command_line(program, unused);
        fmt::print("{}", options.man                   ? man_page(program)
                         : options.completion == "zsh" ? zsh_completion(program)
                                                       : bash_completion(program));
        return 0;
    }
    if (options.target.empty()) {
        const BuildInfo build = build_info();
        fmt::print("rodwake   {} ({})\ncompiler  {}\nbuild     {}\n", build.version, build.git,
                   build.compiler, build.flags);
        for (const auto& [name, version] : build.libraries)
            fmt::print("{:<14} {}\n", name, version);
        fmt::print("cpu       {}\nfeatures  {}\n", cpu_model(), fmt::join(cpu_features(), " "));
        return 0;
    }
    if (!fs::exists(options.target))
        throw InputError(options.target + ": no such file or folder");
    if (fs::is_directory(options.target))
        return describe_run(options.target);
    fmt::print("{}", printable(file_text(options.target)));
    return 0;
}

} // namespace rodwake::cli
