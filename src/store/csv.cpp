#include "rodwake/store/csv.hpp"

#include "rodwake/core/error.hpp"
#include "rodwake/core/spelling.hpp"
#include "text_lines.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <deque>
#include <limits>
#include <string_view>
#include <unordered_set>

namespace rodwake::store {

namespace {

/// Of a table.
constexpr std::size_t most_numbers = 500'000'000;

/// Where in the file we are, for messages.
struct CsvPosition {
    std::string file;
    std::size_t line = 0;
    std::size_t column = 1;

    [[noreturn]] void fail(const std::string& what) const {
        throw InputError(fmt::format("{}:{}:{}: {}", file, line, column, what));
    }
};

std::from_chars_result parse(std::string_view text, double& value) {
    const char* begin = text.data() + (text.starts_with('+') && !text.starts_with("+-") ? 1 : 0);
    return std::from_chars(begin, text.data() + text.size(), value);
}

bool is_number(std::string_view text) {
    double value = 0.0;
    const auto [end, error] = parse(text, value);
    return error == std::errc{} && end == text.data() + text.size();
}

double parse_number(std::string_view field, const std::string& name, bool required, const CsvPosition& at) {
    if (!required && is_missing(field))
        return std::numeric_limits<double>::quiet_NaN();
    if (field.empty())
        at.fail(fmt::format("{}: expected a number, found an empty cell", shown(name)));
    double value = 0.0;
    const auto [end, error] = parse(field, value);
    if (error == std::errc::result_out_of_range)
        at.fail(fmt::format("{} = \"{}\": too large or too small for a double", shown(name), shown(field)));
    if (error != std::errc{} || end != field.data() + field.size()) {
        std::string better(field); // for decimal commas and the exponents of Fortran
        for (char& c : better)
            c = c == ',' ? '.' : c == 'd' || c == 'D' ? 'e' : c;
        at.fail(fmt::format("{}: expected a number, found \"{}\"{}", shown(name), shown(field),
                            is_number(better) ? "; write it as " + better : ""));
    }
    if (!std::isfinite(value))
        at.fail(fmt::format("{} = {}: must be finite", shown(name), shown(field)));
    return value;
}

/// Tables of many rods have tens of thousands of columns.
using Names = std::unordered_set<std::string_view>;

/// A column of the file: passed over, or a column of the table.
struct FileColumn {
    std::string name;
    bool wanted, required;
};

struct Header {
    std::vector<FileColumn> columns;
    std::size_t named = 0; ///< up to the last column with a name
};

/// Programs write an index without a name in front, and a separator behind the last column.
Header read_names(std::string_view line, const LinesOfBlocks& lines, CsvPosition& at) {
    Header header;
    std::deque<std::string> found; // whose addresses stay
    Names names;
    std::size_t gap = 0; ///< place of a column without a name behind one with a name
    bool numbers = true;
    lines.for_each_cell(line, line.npos, [&](std::size_t index, std::string_view cell, std::size_t column) {
        at.column = column;
        const std::string name = text_in(cell);
        header.columns.push_back({name, false, false});
        if (name.empty()) {
            gap = gap == 0 && header.named > 0 ? at.column : gap;
            return;
        }
        at.column = gap > 0 ? gap : at.column;
        if (gap > 0)
            at.fail("empty column name in the header");
        numbers = numbers && is_number(name);
        if (!names.insert(found.emplace_back(name)).second && !numbers)
            at.fail(fmt::format("column \"{}\" appears twice in the header", shown(name)));
        header.named = index + 1;
    });
    at.column = 1;
    if (numbers && header.named > 0)
        at.fail("no header line: here are numbers, not names (lines that begin with # or % are comments)");
    return header;
}

Header read_header(std::string_view line, const LinesOfBlocks& lines, CsvPosition& at,
                   std::span<const std::string> required, std::span<const std::string> optional) {
    Header header = read_names(line, lines, at);
    std::vector<std::string_view> names;
    for (const FileColumn& column : header.columns)
        names.emplace_back(column.name);
    const Names found(names.begin(), names.end());
    const bool blanks = names.size() == 1 && names[0].find_first_of(" \t") != std::string_view::npos;
    for (const std::string& name : required)
        if (!found.contains(name))
            at.fail(fmt::format("no column \"{}\"; the header must have at least {}; it has {}{}",
                                shown(name), fmt::join(required, ","),
                                shown(fmt::format("{}", fmt::join(names, ","))),
                                blanks ? "; columns are separated by commas, semicolons or tabs" : ""));
    const Names needed(required.begin(), required.end()), welcome(optional.begin(), optional.end());
    for (FileColumn& column : header.columns) {
        column.required = needed.contains(column.name);
        column.wanted = column.required || welcome.contains(column.name);
    }
    return header;
}

/// The header and the rows in turn, as long as `use` wants more.
template<class Use>
void for_each_line(const std::filesystem::path& path, std::span<const std::string> required, Use use) {
    LinesOfBlocks lines(path);
    CsvPosition at{lines.name()};
    for (std::string_view line; lines.next_record(line);) {
        at.line = lines.number();
        at.column = 1;
        if (!use(line, lines, at))
            return;
    }
    if (at.line == 0)
        throw InputError(fmt::format("{}: no header line{}{}", at.file,
                                     required.empty() ? "" : "; expected at least ",
                                     fmt::join(required, ",")));
}

} // namespace

const std::vector<double>* Table::find(const std::string& name) const {
    const auto at = std::ranges::find(names, name);
    return at == names.end() ? nullptr : &columns[static_cast<std::size_t>(at - names.begin())];
}

std::vector<std::string> csv_names(const std::filesystem::path& path) {
    std::vector<std::string> names;
    for_each_line(path, {}, [&](std::string_view line, const LinesOfBlocks& lines, CsvPosition& at) {
        for (FileColumn& column : read_names(line, lines, at).columns)
            if (!column.name.empty())
                names.push_back(std::move(column.name));
        return false;
    });
    return names;
}

void for_each_csv_row(const std::filesystem::path& path,
                      const std::function<void(std::string_view, std::span<const std::string>)>& use) {
    Header header;
    std::vector<std::string> fields;
    for_each_line(path, {}, [&](std::string_view line, const LinesOfBlocks& lines, CsvPosition& at) {
        if (header.columns.empty())
            header = read_names(line, lines, at);
        fields.clear();
        lines.for_each_cell(line, header.columns.size(),
                            [&](std::size_t index, std::string_view cell, std::size_t) {
                                if (!header.columns[index].name.empty())
                                    fields.push_back(text_in(cell));
                            });
        use(line, fields);
        return true;
    });
}

Table read_csv(const std::filesystem::path& path, std::span<const std::string> required,
               std::span<const std::string> optional) {
    Table table;
    Header header;
    for_each_line(path, required, [&](std::string_view line, const LinesOfBlocks& lines, CsvPosition& at) {
        if (header.columns.empty()) {
            header = read_header(line, lines, at, required, optional);
            for (const FileColumn& column : header.columns)
                if (column.wanted)
                    table.names.push_back(column.name);
            table.columns.resize(table.names.size());
            return true;
        }
        std::size_t fields = 0, next = 0;
        lines.for_each_cell(
            line, line.npos, [&](std::size_t index, std::string_view cell, std::size_t column) {
                at.column = column;
                const std::string_view field = bare(cell);
                if (index >= header.columns.size() && field.empty()) // behind the last one
                    return;
                fields = index + 1;
                if (index < header.columns.size() && header.columns[index].wanted)
                    table.columns[next++].push_back(
                        parse_number(field, header.columns[index].name, header.columns[index].required, at));
            });
        if (fields < header.named || fields > header.columns.size())
            at.fail(fmt::format("{} fields, but the header has {}", fields, header.columns.size()));
        table.lines.push_back(at.line);
        if (table.rows() * table.columns.size() > most_numbers) // gzip's files are small until they are read
            at.fail(fmt::format("more than {} numbers, {} GB of memory: take fewer rows", most_numbers,
                                most_numbers / 125'000'000));
        return true;
    });
    return table;
}

std::string to_csv(std::span<const std::string> names, std::span<const std::vector<double>> columns) {
    fmt::memory_buffer out;
    fmt::format_to(std::back_inserter(out), "{}\n", fmt::join(names, ","));
    const std::size_t rows = columns.empty() ? 0 : columns.front().size();
    for (std::size_t row = 0; row < rows; ++row) {
        for (std::size_t column = 0; column < columns.size(); ++column) {
            // NaN is written as an empty field, which is how it is read.
            const auto value = columns[column][row];
            if (column > 0)
                out.push_back(',');
            if (!std::isnan(value))
                fmt::format_to(std::back_inserter(out), "{:.17g}", value);
        }
        out.push_back('\n');
    }
    return fmt::to_string(out);
}

} // namespace rodwake::store
