#pragma once
// Text files of tracks: their lines, block by block, and the words and numbers of a line.

#include "rodwake/core/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <zlib.h>

namespace rodwake::store {

inline std::string_view without_blanks(std::string_view text) {
    while (!text.empty() && (text.front() == ' ' || text.front() == '\t'))
        text.remove_prefix(1);
    while (!text.empty() && (text.back() == ' ' || text.back() == '\t'))
        text.remove_suffix(1);
    return text;
}

/// A cell without the blanks and quotes around it; quotes within are still doubled.
inline std::string_view bare(std::string_view cell) {
    cell = without_blanks(cell);
    if (cell.size() >= 2 && cell.front() == '"' && cell.back() == '"')
        cell = without_blanks(cell.substr(1, cell.size() - 2));
    return cell;
}

/// As its writer meant it.
inline std::string text_in(std::string_view cell) {
    std::string text(bare(cell));
    for (std::size_t at = 0; (at = text.find("\"\"", at)) != std::string::npos; ++at)
        text.erase(at, 1);
    return text;
}

/// Where the cell that begins at `start` ends: at a separator or the end of the text, npos if a quote is
/// opened and not closed. A quote opens a cell only as its first character, and is doubled within. `searched`
/// is how far the end of an open quote was looked for before.
inline std::size_t end_of_cell(std::string_view text, char separator, std::size_t start,
                               std::size_t searched = 0) {
    constexpr std::size_t none = std::string_view::npos;
    std::size_t at = text.find_first_not_of(separator == '\t' ? " " : " \t", start);
    if (at == none || text[at] != '"')
        return std::min(text.find(separator, start), text.size());
    for (at = std::max(at + 1, searched); (at = text.find('"', at)) != none; at += 2)
        if (!text.substr(at + 1).starts_with('"'))
            return std::min(text.find(separator, at), text.size());
    return none;
}

/// Lines of a file that is read block by block, unpacked if it is gzip's; they end with LF, CR LF, or, in a
/// file without LF, with CR.
class LinesOfBlocks {
public:
    explicit LinesOfBlocks(const std::filesystem::path& path)
        : name_(path == "-" ? "standard input" : path.string()),
          file_(::gzopen(path == "-" ? "/dev/stdin" : path.c_str(), "rb"), ::gzclose) {
        std::error_code error;
        if (std::filesystem::is_directory(path, error))
            throw InputError(name_ + ": is a folder, expected a file of text");
        if (!file_)
            throw InputError(name_ + ": cannot read the file (does it exist?)");
        const auto size = std::filesystem::file_size(path, error);
        size_ = error ? 0.0 : static_cast<double>(size); // a pipe has none
        ::gzbuffer(file_.get(), 1U << 17);
        fill();
        const std::string_view head = std::string_view(text_).substr(0, text_.find_first_of("\r\n"));
        const auto nuls = static_cast<std::size_t>(std::ranges::count(head, '\0'));
        if (head.starts_with("\xFF\xFE") || head.starts_with("\xFE\xFF") || 3 * nuls > head.size())
            throw InputError(name_ +
                             ": this is UTF-16, text of two bytes a character: save it as CSV in UTF-8, "
                             "or convert it by iconv -f UTF-16 -t UTF-8");
        if (nuls > 0)
            throw InputError(name_ + ": this is binary, no text: save the table as CSV in UTF-8");
        if (text_.starts_with("\xEF\xBB\xBF"))
            at_ = 3;
        if (text_.find('\n') == std::string::npos && text_.find('\r') != std::string::npos)
            end_of_line_ = '\r';
    }

    /// A row of a table, whose quoted cells may hold ends of lines; comments and rows of nothing are passed
    /// over. The first row decides the separator.
    bool next_record(std::string_view& record) {
        for (std::size_t first = std::string_view::npos; first == std::string_view::npos;) {
            begin_ = at_;
            const bool any = extend(record);
            number_ = lines_;
            if (!any)
                return false;
            first = record.find_first_not_of(",; \t");
            if (first < record.size() && (record[first] == '#' || record[first] == '%') &&
                record.find_first_not_of(" \t") == first)
                first = std::string_view::npos;
        }
        if (separator_ == '\0') {
            // The comma, semicolon or tab that stands most often outside quotes.
            constexpr std::string_view known = ",;\t";
            std::size_t count[known.size()] = {};
            bool quoted = false;
            for (const char c : record) {
                quoted ^= c == '"';
                if (const std::size_t which = known.find(c); which != std::string_view::npos && !quoted)
                    ++count[which];
            }
            separator_ = known[static_cast<std::size_t>(std::ranges::max_element(count) - count)];
        }
        quotes_ = record.find('"') != std::string_view::npos;
        for (std::size_t start = 0, searched = 0; quotes_ && start <= record.size();) {
            const std::size_t end = end_of_cell(record, separator_, start, searched);
            searched = end == std::string_view::npos ? record.size() : 0;
            if (end != std::string_view::npos)
                start = end + 1;
            else if (!extend(record))
                throw InputError(
                    fmt::format("{}:{}:{}: a quote is opened and not closed", name_, number_, start + 1));
        }
        return true;
    }

    /// Of this record: calls use(index, cell, column) for the first `most` cells, columns counted from 1;
    /// returns how many there are in all.
    template<class Use>
    std::size_t for_each_cell(std::string_view record, std::size_t most, const Use& use) const {
        for (std::size_t index = 0, start = 0;; ++index) {
            std::size_t end = start;
            if (quotes_)
                end = end_of_cell(record, separator_, start);
            else // cells are short: a call of memchr for each takes longer
                while (end != record.size() && record[end] != separator_)
                    ++end;
            if (index < most)
                use(index, record.substr(start, end - start), start + 1);
            else if (!quotes_)
                return index + 1 +
                       static_cast<std::size_t>(std::ranges::count(record.substr(end), separator_));
            if (end == record.size())
                return index + 1;
            start = end + 1;
        }
    }

    const std::string& name() const { return name_; }
    char separator() const { return separator_; }
    /// Of the line that the record begins with.
    std::size_t number() const { return number_; }
    /// Of the file that has been read.
    double part() const {
        return size_ > 0.0 ? std::min(1.0, static_cast<double>(::gzoffset(file_.get())) / size_) : 1.0;
    }
    double bytes() const { return size_; }

private:
    static constexpr std::size_t longest = std::size_t{1} << 24;

    /// The line, or the record, with one more line.
    bool extend(std::string_view& line) {
        std::size_t end = text_.find(end_of_line_, at_);
        while (end == std::string::npos && fill()) {
            if (text_.size() > longest)
                throw InputError(fmt::format("{}:{}: {} of more than {} MB: is this a file of text?", name_,
                                             begin_ == at_ ? lines_ + 1 : number_,
                                             begin_ == at_ ? "a line" : "a quoted cell", longest >> 20));
            end = text_.find(end_of_line_, at_);
        }
        if (at_ >= text_.size())
            return false;
        end = std::min(end, text_.size());
        line = std::string_view(text_).substr(begin_, end - begin_);
        while (line.ends_with('\r'))
            line.remove_suffix(1);
        at_ = end + 1;
        ++lines_;
        return true;
    }

    /// Another block behind what is not used yet; false at the end of the file.
    bool fill() {
        const auto block = static_cast<std::size_t>(std::clamp(size_ + 1.0, 0x1p16, 0x1p22));
        begin_ = std::min(begin_, text_.size());
        text_.erase(0, begin_);
        at_ -= begin_;
        begin_ = 0;
        const std::size_t kept = text_.size();
        text_.resize(kept + block);
        const int found = ::gzread(file_.get(), text_.data() + kept, static_cast<unsigned>(block));
        int error = Z_OK;
        const std::string why = ::gzerror(file_.get(), &error);
        if (error == Z_BUF_ERROR)
            throw InputError(name_ + ": ends within its gzip data: was it copied or downloaded whole?");
        if (error == Z_DATA_ERROR)
            throw InputError(name_ + ": its gzip data are damaged: " + why);
        if (found < 0)
            throw InputError(name_ + ": cannot be read: " + why);
        text_.resize(kept + static_cast<std::size_t>(found));
        return found > 0;
    }

    std::string name_;
    std::unique_ptr<gzFile_s, decltype(&::gzclose)> file_;
    std::string text_;
    std::size_t begin_ = 0, at_ = 0; ///< of the line, and of what follows it
    std::size_t number_ = 0, lines_ = 0;
    double size_ = 0.0;
    char end_of_line_ = '\n', separator_ = '\0';
    bool quotes_ = false; ///< in the record
};

inline bool alike(std::string_view a, std::string_view b) {
    const auto lower = [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; };
    return std::ranges::equal(a, b, {}, lower, lower);
}

/// What programs write where there is no value.
inline bool is_missing(std::string_view cell) {
    if (cell.empty() || cell == "-")
        return true;
    if (cell.front() >= '0' && cell.front() <= '9')
        return false;
    constexpr std::string_view words[] = {"nan", "na", "<na>", "n/a", "none", "null", "-nan", "#n/a", "nat"};
    return std::ranges::any_of(words, [&](std::string_view word) { return alike(cell, word); });
}

/// Of the whole text; a '+' before it is fine.
inline std::optional<double> number_in(std::string_view cell) {
    double value = 0.0;
    if (cell.starts_with('+'))
        cell.remove_prefix(1);
    const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
    if (error != std::errc{} || end != cell.data() + cell.size())
        return std::nullopt;
    return value;
}

} // namespace rodwake::store
