#pragma once
// Text files of tracks: their lines, block by block, and the words and numbers of a line.

#include "rodwake/core/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <string_view>

namespace rodwake::store {

/// Lines of a file that is read block by block; they end with LF, CR LF, or, in a file without LF, with CR.
class LinesOfBlocks {
public:
    explicit LinesOfBlocks(const std::filesystem::path& path)
        : name_(path.string()), file_(path, std::ios::binary),
          size_(static_cast<double>(std::filesystem::file_size(path))) {
        if (!file_.is_open())
            throw InputError(name_ + ": cannot be read");
        fill();
        if (text_.starts_with("\xEF\xBB\xBF"))
            at_ = 3;
        const std::size_t break_at = text_.find_first_of("\r\n");
        if (break_at != std::string::npos && text_.find('\n') == std::string::npos)
            end_of_line_ = '\r';
    }

    bool next(std::string_view& line) {
        std::size_t end = text_.find(end_of_line_, at_);
        while (end == std::string::npos && fill()) {
            if (text_.size() > longest)
                throw InputError(fmt::format("{}:{}: a line of more than {} MB: is this a file of text?",
                                             name_, number_ + 1, longest >> 20));
            end = text_.find(end_of_line_, at_);
        }
        if (at_ >= text_.size())
            return false;
        end = std::min(end, text_.size());
        line = std::string_view(text_).substr(at_, end - at_);
        if (line.ends_with('\r'))
            line.remove_suffix(1);
        at_ = end + 1;
        ++number_;
        return true;
    }

    std::size_t number() const { return number_; }
    /// Of the file that has been read.
    double part() const { return size_ > 0.0 ? std::min(1.0, read_ / size_) : 1.0; }
    double bytes() const { return size_; }

private:
    static constexpr std::size_t longest = std::size_t{1} << 24;

    /// Another block behind what is not used yet; false at the end of the file.
    bool fill() {
        const auto block = static_cast<std::size_t>(std::min(size_ + 1.0, 0x1p22));
        text_.erase(0, std::min(at_, text_.size()));
        at_ = 0;
        const std::size_t kept = text_.size();
        text_.resize(kept + block);
        file_.read(text_.data() + kept, static_cast<std::streamsize>(block));
        const auto found = static_cast<std::size_t>(file_.gcount());
        text_.resize(kept + found);
        read_ += static_cast<double>(found);
        return found > 0;
    }

    std::string name_;
    std::ifstream file_;
    std::string text_;
    std::size_t at_ = 0, number_ = 0;
    double size_, read_ = 0.0;
    char end_of_line_ = '\n';
};

inline std::string_view without_blanks(std::string_view text) {
    while (!text.empty() && (text.front() == ' ' || text.front() == '\t'))
        text.remove_prefix(1);
    while (!text.empty() && (text.back() == ' ' || text.back() == '\t'))
        text.remove_suffix(1);
    return text;
}

inline bool alike(std::string_view a, std::string_view b) {
    const auto lower = [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; };
    return std::ranges::equal(a, b, {}, lower, lower);
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

/// Takes the first word, behind blanks, off a line; empty at its end.
inline std::string_view next_word(std::string_view& line) {
    while (!line.empty() && (line.front() == ' ' || line.front() == '\t'))
        line.remove_prefix(1);
    const std::size_t end = std::min(line.find_first_of(" \t"), line.size());
    const std::string_view word = line.substr(0, end);
    line.remove_prefix(end);
    return word;
}

/// A whole number below 2^53, perhaps written as 12.0.
inline std::optional<std::int64_t> whole_in(std::string_view text) {
    std::int64_t value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    constexpr std::int64_t most = std::int64_t{1} << 53;
    if (error == std::errc{} && end == text.data() + text.size() && value > -most && value < most)
        return value;
    const auto number = number_in(text);
    if (!number || !(std::abs(*number) < 0x1p53) || *number != std::floor(*number))
        return std::nullopt;
    return static_cast<std::int64_t>(*number);
}

} // namespace rodwake::store
