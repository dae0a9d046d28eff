#include "nesting.hpp"

namespace rodwake::scene {

namespace {

/// Walks over TOML text, skipping comments and the insides of strings.
class Scanner {
public:
    explicit Scanner(std::string_view text) : text_(text) {}

    std::optional<TextPosition> find_deep_key() {
        int dots = 0;
        while (at_ < text_.size()) {
            const char c = text_[at_];
            if (c == '#')
                skip_comment();
            else if (c == '"' || c == '\'')
                skip_string(c);
            else {
                if (c == '.' && ++dots > max_key_dots)
                    return position_;
                if (std::string_view("=,[]{}\n").find(c) != std::string_view::npos)
                    dots = 0;
                advance();
            }
        }
        return std::nullopt;
    }

private:
    void advance(std::size_t count = 1) {
        for (; count > 0 && at_ < text_.size(); --count, ++at_)
            if (text_[at_] == '\n')
                position_ = {position_.line + 1, 1};
            else
                ++position_.column;
    }

    void skip_comment() {
        while (at_ < text_.size() && text_[at_] != '\n')
            advance();
    }

    void skip_string(char quote) {
        const char triple[] = {quote, quote, quote};
        const std::string_view fence(triple, 3);
        const bool multi_line = text_.substr(at_, 3) == fence;
        const std::string_view end = multi_line ? fence : fence.substr(0, 1);
        advance(end.size());
        while (at_ < text_.size() && text_.substr(at_, end.size()) != end) {
            if (!multi_line && text_[at_] == '\n')
                return; // unterminated: the parser stops here, too
            advance(quote == '"' && text_[at_] == '\\' ? 2 : 1);
        }
        advance(end.size());
    }

    std::string_view text_;
    std::size_t at_ = 0;
    TextPosition position_;
};

} // namespace

std::optional<TextPosition> find_deep_key(std::string_view text) { return Scanner(text).find_deep_key(); }

} // namespace rodwake::scene
