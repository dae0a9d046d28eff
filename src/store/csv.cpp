#include "rodwake/store/csv.hpp"

#include "rodwake/core/error.hpp"
#include "rodwake/core/spelling.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
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

/// Lines that end with LF, CR LF or CR.
class Lines {
public:
    explicit Lines(std::ifstream file) : file_(std::move(file)) {}

    bool next(std::string& line) {
        if (from_ > some_.size()) {
            if (!std::getline(file_, some_))
                return false;
            if (some_.ends_with('\r'))
                some_.pop_back();
            from_ = 0;
        }
        const std::size_t end = std::min(some_.find('\r', from_), some_.size());
        line.assign(some_, from_, end - from_);
        from_ = end + 1;
        return true;
    }

private:
    std::ifstream file_;
    std::string some_; ///< up to the next LF
    std::size_t from_ = 1;
};

constexpr std::string_view separators = ",;\t";

/// The one that stands in the header most often outside quotes; a comma if none does.
char separator_of(std::string_view header) {
    std::array<std::size_t, separators.size()> count{};
    bool quoted = false;
    for (const char c : header) {
        quoted ^= c == '"';
        if (const auto which = separators.find(c); which != std::string_view::npos && !quoted)
            ++count[which];
    }
    return separators[static_cast<std::size_t>(std::ranges::max_element(count) - count.begin())];
}

/// One field of a line and where the next one starts.
struct Field {
    std::string text;
    std::size_t next;
};

Field plain_field(std::string_view line, char separator, std::size_t start) {
    const std::size_t end = std::min(line.find(separator, start), line.size());
    return {std::string(trimmed(line.substr(start, end - start))), end + 1};
}

/// The field whose opening quote stands at `quote`; a quote within is doubled.
Field quoted_field(std::string_view line, char separator, std::size_t quote, const Place& at) {
    std::string text;
    std::size_t i = quote + 1;
    for (; i < line.size() && (line[i] != '"' || line.substr(i, 2) == "\"\""); ++i) {
        i += line[i] == '"';
        text += line[i];
    }
    if (i >= line.size())
        at.fail("a quote is opened and not closed on this line");
    const Field rest = plain_field(line, separator, i + 1);
    if (!rest.text.empty())
        at.fail(fmt::format("\"{}\" follows the closing quote", shown(rest.text)));
    return {std::string(trimmed(text)), rest.next};
}

template<class Use>
void for_each_field(std::string_view line, char separator, Place& at, Use use) {
    const char* blanks = separator == '\t' ? " " : " \t";
    for (std::size_t start = 0, index = 0; start <= line.size(); ++index) {
        at.column = start + 1;
        const std::size_t first = std::min(line.find_first_not_of(blanks, start), line.size());
        const bool is_quoted = line.substr(first).starts_with('"');
        const Field field =
            is_quoted ? quoted_field(line, separator, first, at) : plain_field(line, separator, start);
        use(index, std::string_view(field.text));
        start = field.next;
    }
}

std::from_chars_result parse(std::string_view text, double& value) {
    const char* begin = text.data() + (text.starts_with('+') && !text.starts_with("+-") ? 1 : 0);
    return std::from_chars(begin, text.data() + text.size(), value);
}

bool is_number(std::string_view text) {
    double value = 0.0;
    const auto [end, error] = parse(text, value);
    return error == std::errc{} && end == text.data() + text.size();
}

/// For decimal commas and the exponents of Fortran.
std::string better(std::string text) {
    for (char& c : text)
        c = c == ',' ? '.' : c == 'd' || c == 'D' ? 'e' : c;
    return is_number(text) ? "; write it as " + text : "";
}

double parse_number(std::string_view field, const std::string& name, bool required, const Place& at) {
    if (field.empty() && !required)
        return std::numeric_limits<double>::quiet_NaN();
    if (field.empty())
        at.fail(fmt::format("{}: expected a number, found an empty cell", shown(name)));
    double value = 0.0;
    const auto [end, error] = parse(field, value);
    if (error == std::errc::result_out_of_range)
        at.fail(fmt::format("{} = \"{}\": too large or too small for a double", shown(name), shown(field)));
    if (error != std::errc{} || end != field.data() + field.size())
        at.fail(fmt::format("{}: expected a number, found \"{}\"{}", shown(name), shown(field),
                            better(std::string(field))));
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
    char separator = ',';
    std::vector<FileColumn> columns;
    std::size_t named = 0; ///< up to the last column with a name
};

/// Programs write an index without a name in front, and a separator behind the last column.
Header read_names(std::string_view line, Place& at) {
    Header header{separator_of(line), {}, 0};
    std::deque<std::string> found; // whose addresses stay
    Names names;
    std::size_t gap = 0; ///< place of a column without a name behind one with a name
    bool numbers = true;
    for_each_field(line, header.separator, at, [&](std::size_t index, std::string_view name) {
        header.columns.push_back({std::string(name), false, false});
        if (name.empty()) {
            gap = gap == 0 && header.named > 0 ? at.column : gap;
            return;
        }
        at.column = gap > 0 ? gap : at.column;
        if (gap > 0)
            at.fail("empty column name in the header");
        numbers = numbers && is_number(name);
        if (!names.insert(found.emplace_back(name)).second && !numbers)
            at.fail(fmt::format("column \"{}\" stands twice in the header", shown(name)));
        header.named = index + 1;
    });
    at.column = 1;
    if (numbers && header.named > 0)
        at.fail("no header line: here are numbers, not names (lines that begin with # or % are comments)");
    return header;
}

void require_columns(const Header& header, const Place& at, std::span<const std::string> required) {
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
}

Header read_header(std::string_view line, Place& at, std::span<const std::string> required,
                   std::span<const std::string> optional) {
    Header header = read_names(line, at);
    require_columns(header, at, required);
    const Names needed(required.begin(), required.end()), welcome(optional.begin(), optional.end());
    for (FileColumn& column : header.columns) {
        column.required = needed.contains(column.name);
        column.wanted = column.required || welcome.contains(column.name);
    }
    return header;
}

Table empty_table(const Header& header) {
    Table table;
    for (const FileColumn& column : header.columns)
        if (column.wanted)
            table.names.push_back(column.name);
    table.columns.resize(table.names.size());
    return table;
}

void read_row(std::string_view line, Place& at, const Header& header, Table& table) {
    std::size_t fields = 0, next = 0;
    for_each_field(line, header.separator, at, [&](std::size_t index, std::string_view field) {
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
}

/// Spreadsheets put a mark before UTF-8 text, and may write two bytes a character.
void require_text(std::string& line, const Place& at) {
    if (at.line == 1 && line.starts_with("\xEF\xBB\xBF"))
        line.erase(0, 3);
    const bool marked = at.line == 1 && (line.starts_with("\xFF\xFE") || line.starts_with("\xFE\xFF"));
    if (marked || line.find('\0') != std::string::npos)
        at.fail("this is no plain text but UTF-16 or binary: save the table as CSV in UTF-8");
}

/// Comments, and rows without anything in them.
bool is_passed_over(std::string_view line) {
    const std::string_view text = trimmed(line);
    return text.starts_with('#') || text.starts_with('%') || text.find_first_not_of(",; \t") == text.npos;
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

/// The header and the rows in turn, as long as `use` wants more.
template<class Use>
void for_each_line(const std::filesystem::path& path, std::span<const std::string> required, Use use) {
    Lines lines(open(path));
    Place at{is_standard_input(path) ? "standard input" : path.string()};
    bool any = false;
    for (std::string line; lines.next(line);) {
        ++at.line;
        at.column = 1;
        require_text(line, at);
        if (is_passed_over(line))
            continue;
        any = true;
        if (!use(line, at))
            return;
    }
    if (!any)
        throw InputError(fmt::format("{}: no header line{}{}", at.file,
                                     required.empty() ? "" : "; expected at least ",
                                     fmt::join(required, ",")));
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

std::vector<std::string> csv_names(const std::filesystem::path& path) {
    std::vector<std::string> names;
    for_each_line(path, {}, [&](std::string_view line, Place& at) {
        for (FileColumn& column : read_names(line, at).columns)
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
    for_each_line(path, {}, [&](std::string_view line, Place& at) {
        if (header.columns.empty())
            header = read_names(line, at);
        fields.clear();
        for_each_field(line, header.separator, at, [&](std::size_t index, std::string_view field) {
            if (index < header.columns.size() && !header.columns[index].name.empty())
                fields.emplace_back(field);
        });
        use(line, fields);
        return true;
    });
}

Table read_csv(const std::filesystem::path& path, std::span<const std::string> required,
               std::span<const std::string> optional) {
    Table table;
    Header header;
    for_each_line(path, required, [&](std::string_view line, Place& at) {
        if (header.columns.empty()) {
            header = read_header(line, at, required, optional);
            table = empty_table(header);
        } else {
            read_row(line, at, header, table);
        }
        return true;
    });
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
