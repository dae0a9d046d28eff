#include "describe_file.hpp"

#include "rodwake/core/error.hpp"
#include "rodwake/scan/ledger.hpp"
#include "rodwake/stages/run.hpp"
#include "rodwake/store/hdf5_reader.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <deque>
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

void add_row(const std::string& row, std::vector<ColumnContent>& columns) {
    std::size_t start = 0;
    for (ColumnContent& column : columns) {
        const std::size_t end = std::min(row.find(',', start), row.size());
        column.add(std::string_view(row).substr(std::min(start, row.size()), end - std::min(start, end)));
        start = end + 1;
    }
}

std::string table_text(const fs::path& file) {
    constexpr std::size_t most_columns = 60, ends = 3;
    const std::vector<stages::ColumnEntry> names = stages::columns_of(file);
    std::vector<ColumnContent> columns(names.size());
    std::vector<std::string> first;
    std::deque<std::string> last;
    std::ifstream in = opened(file);
    std::string header, row;
    while (std::getline(in, header) && header.starts_with('#')) {
    }
    std::size_t rows = 0;
    for (; std::getline(in, row); ++rows) {
        if (row.ends_with('\r'))
            row.pop_back();
        add_row(row, columns);
        if (rows < ends)
            first.push_back(row);
        else if (last.push_back(row); last.size() > ends)
            last.pop_front();
    }
    std::string text = fmt::format("{} rows, {} columns\n", rows, names.size());
    for (std::size_t k = 0; k < std::min(names.size(), most_columns); ++k)
        text += fmt::format("  {:<24} {:<10} {:<28} {}\n", names[k].name, names[k].unit, columns[k].text(),
                            names[k].meaning);
    if (names.size() > most_columns)
        text += fmt::format("  ... {} more columns\n", names.size() - most_columns);
    text += "\n" + cut(header) + "\n";
    for (const std::string& one : first)
        text += cut(one) + "\n";
    if (rows > 2 * ends)
        text += fmt::format("... {} rows ...\n", rows - 2 * ends);
    for (const std::string& one : last)
        text += cut(one) + "\n";
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
        std::istringstream text(shortened(ordered_json::parse(in)).dump(2));
        return text_text(text);
    } catch (const ordered_json::exception& error) {
        throw InputError(fmt::format("{}: not valid JSON: {}", file.string(), error.what()));
    }
}

std::string ledger_text(const fs::path& file) {
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

std::string hdf5_text(const fs::path& file) {
    try {
        return store::list_hdf5(file);
    } catch (const InputError& error) {
        throw InputError(fmt::format("{}, and nothing else that info knows: CSV, JSON, TOML and text, "
                                     "checkpoints (.rwc), ledger.sqlite, figures, a run folder",
                                     error.what()));
    }
}

/// Of a file that is to be looked at with another program.
std::string picture_text(const fs::path& file) {
    const std::string what = stages::what_of(file);
    return fmt::format("{}; {} bytes; open it with a viewer or a browser\n",
                       what.empty() ? "a figure, page or film" : what, fs::file_size(file));
}

bool ends_in(const std::string& ending, std::initializer_list<std::string_view> endings) {
    return std::ranges::find(endings, ending) != endings.end();
}

} // namespace

std::string file_text(const fs::path& file) {
    const std::string ending = file.extension().string();
    std::string start(64, '\0');
    std::ifstream in = opened(file);
    in.read(start.data(), static_cast<std::streamsize>(start.size()));
    start.resize(static_cast<std::size_t>(in.gcount()));
    if (start.empty())
        throw InputError(file.string() + ": is empty");
    if (start.starts_with("SQLite format 3"))
        return ledger_text(file);
    if (start.starts_with("\x89PNG") || ends_in(ending, {".pdf", ".html", ".gif", ".mp4", ".webm", ".svg"}))
        return picture_text(file);
    if (ending == ".rwc")
        return stages::describe_checkpoint(file);
    if (ending == ".csv")
        return table_text(file);
    if (ending == ".json")
        return json_text(file);
    std::ifstream again = opened(file);
    if (ends_in(ending, {".toml", ".txt", ".xyz", ".vti", ".lock"}))
        return text_text(again);
    if (const std::string what = stages::what_of(file); ending == ".log" && !what.empty())
        return fmt::format("{}; {} bytes\n", what, fs::file_size(file));
    return hdf5_text(file);
}

} // namespace rodwake::cli
