#include "rodwake/store/csv.hpp"

#include "rodwake/core/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <deque>
#include <fstream>
#include <limits>
#include <string_view>
#include <unordered_set>

namespace rodwake::store {

namespace {

/// Where in the file we are, for messages.
struct Place {
    std::string file;
    std::size_t line = 0;
    std::size_t column = 1;

    [[noreturn]] void fail(const std::string& what) const {
        throw InputError(fmt::format("{}:{}:{}: {}", file, line, column, what));
    }
};

std::string_view trimmed(std::string_view text) {
    const auto first = text.find_first_not_of(" \t\r");
    if (first == std::string_view::npos)
        return {};
    return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

/// One field of a line and where the next one starts.
struct Field {
    std::string text;
    std::size_t next;
};

Field plain_field(std::string_view line, std::size_t start) {
    const std::size_t end = std::min(line.find(',', start), line.size());
    return {std::string(trimmed(line.substr(start, end - start))), end + 1};
}

/// The field whose opening quote stands at `quote`; a quote within is doubled.
Field quoted_field(std::string_view line, std::size_t quote, const Place& at) {
    std::string text;
    std::size_t i = quote + 1;
    for (; i < line.size() && (line[i] != '"' || line.substr(i, 2) == "\"\""); ++i) {
        i += line[i] == '"';
        text += line[i];
    }
    if (i >= line.size())
        at.fail("a quote is opened and not closed on this line");
    const Field rest = plain_field(line, i + 1);
    if (!rest.text.empty())
        at.fail(fmt::format("\"{}\" follows the closing quote", rest.text.substr(0, 40)));
    return {std::string(trimmed(text)), rest.next};
}

template<class Use>
void for_each_field(std::string_view line, Place& at, Use use) {
    for (std::size_t start = 0, index = 0; start <= line.size(); ++index) {
        at.column = start + 1;
        const std::size_t first = std::min(line.find_first_not_of(" \t", start), line.size());
        const bool is_quoted = line.substr(first).starts_with('"');
        const Field field = is_quoted ? quoted_field(line, first, at) : plain_field(line, start);
        use(index, std::string_view(field.text));
        start = field.next;
    }
}

double parse_number(std::string_view field, const std::string& name, bool required, const Place& at) {
    if (field.empty() && !required)
        return std::numeric_limits<double>::quiet_NaN();
    double value = 0.0;
    const char* begin = field.data() + (field.starts_with('+') && !field.starts_with("+-") ? 1 : 0);
    const auto [end, error] = std::from_chars(begin, field.data() + field.size(), value);
    if (error == std::errc::result_out_of_range)
        at.fail(fmt::format("{} = \"{}\": too large or too small for a double", name, field));
    if (error != std::errc{} || end != field.data() + field.size())
        at.fail(fmt::format("{}: expected a number, found \"{}\"", name, field.substr(0, 40)));
    if (!std::isfinite(value))
        at.fail(fmt::format("{} = {}: must be finite", name, field));
    return value;
}

/// Tables of many rods have tens of thousands of columns.
using Names = std::unordered_set<std::string_view>;

/// A column of the file: passed over, or a column of the table.
struct FileColumn {
    std::string name;
    bool wanted, required;
};
using Header = std::vector<FileColumn>;

Header read_header(std::string_view line, Place& at, std::span<const std::string> required,
                   std::span<const std::string> optional) {
    const Names needed(required.begin(), required.end()), welcome(optional.begin(), optional.end());
    std::deque<std::string> found; // whose addresses stay
    Names names;
    Header header;
    for_each_field(line, at, [&](std::size_t, std::string_view name) {
        if (name.empty())
            at.fail("empty column name in the header");
        if (!names.insert(found.emplace_back(name)).second)
            at.fail(fmt::format("column \"{}\" stands twice in the header", name));
        const bool is_required = needed.contains(name);
        header.push_back({std::string(name), is_required || welcome.contains(name), is_required});
    });
    at.column = 1;
    for (const std::string& name : required)
        if (!names.contains(name))
            at.fail(fmt::format("no column \"{}\"; the header must have at least {}", name,
                                fmt::join(required, ",")));
    return header;
}

Table empty_table(const Header& header) {
    Table table;
    for (const FileColumn& column : header)
        if (column.wanted)
            table.names.push_back(column.name);
    table.columns.resize(table.names.size());
    return table;
}

void read_row(std::string_view line, Place& at, const Header& header, Table& table) {
    std::size_t fields = 0, next = 0;
    for_each_field(line, at, [&](std::size_t index, std::string_view field) {
        ++fields;
        if (index < header.size() && header[index].wanted)
            table.columns[next++].push_back(
                parse_number(field, header[index].name, header[index].required, at));
    });
    if (fields != header.size())
        at.fail(fmt::format("{} fields, but the header has {}", fields, header.size()));
    table.lines.push_back(at.line);
}

/// Spreadsheets put this before UTF-8 text.
void drop_byte_order_mark(std::string& line) {
    if (line.starts_with("\xEF\xBB\xBF"))
        line.erase(0, 3);
}

bool is_standard_input(const std::filesystem::path& path) { return path == "-"; }

std::ifstream open(const std::filesystem::path& path) {
    if (is_standard_input(path))
        return std::ifstream("/dev/stdin");
    std::error_code error;
    if (std::filesystem::is_directory(path, error))
        throw InputError(path.string() + ": is a folder, expected a CSV file");
    std::ifstream file(path);
    if (!file)
        throw InputError(path.string() + ": cannot read the file (does it exist?)");
    return file;
}

/// NaN as an empty field, which is how it is read.
void append_field(fmt::memory_buffer& out, bool comma, double value) {
    if (comma)
        out.push_back(',');
    if (!std::isnan(value))
        fmt::format_to(std::back_inserter(out), "{:.17g}", value);
}

} // namespace

const std::vector<double>* Table::find(const std::string& name) const {
    const auto at = std::ranges::find(names, name);
    return at == names.end() ? nullptr : &columns[static_cast<std::size_t>(at - names.begin())];
}

Table read_csv(const std::filesystem::path& path, std::span<const std::string> required,
               std::span<const std::string> optional) {
    std::ifstream file = open(path);
    Table table;
    Header header;
    const std::string name = is_standard_input(path) ? "standard input" : path.string();
    Place at{name};
    for (std::string line; std::getline(file, line);) {
        if (++at.line == 1)
            drop_byte_order_mark(line);
        if (trimmed(line).empty() || trimmed(line).front() == '#')
            continue;
        if (header.empty()) {
            header = read_header(line, at, required, optional);
            table = empty_table(header);
        } else {
            read_row(line, at, header, table);
        }
    }
    if (header.empty())
        throw InputError(
            fmt::format("{}: no header line; expected at least {}", name, fmt::join(required, ",")));
    return table;
}

std::string to_csv(std::span<const std::string> names, std::span<const std::vector<double>> columns) {
    fmt::memory_buffer out;
    fmt::format_to(std::back_inserter(out), "{}\n", fmt::join(names, ","));
    const std::size_t rows = columns.empty() ? 0 : columns.front().size();
    for (std::size_t row = 0; row < rows; ++row) {
        for (std::size_t column = 0; column < columns.size(); ++column)
            append_field(out, column > 0, columns[column][row]);
        out.push_back('\n');
    }
    return fmt::to_string(out);
}

} // namespace rodwake::store
