// A text of commands, divided into tokens: words and the marks between them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

#include "oi/text/text_slice.hpp"

namespace cargobay::oi {

struct Token {
  enum class Kind : std::uint8_t { word, separator, open, close, end };
  Kind kind = Kind::end;
  std::string_view text{};
  std::size_t position = 0;  // in bytes from the beginning

  // A part of the word, as a word.
  constexpr Token part(std::size_t begin, std::size_t count) const {
    return {kind, slice(text, begin, count), position + begin};
  }
};

// `;` and the end of a line separate commands, `{` and `}` enclose a script, `#` at the beginning
// of a word makes the rest of the line a comment.
class CommandLexer {
 public:
  constexpr explicit CommandLexer(std::string_view text) : text_{text} {}

  constexpr Token next() {
    skip_blanks();
    if (at_ == text_.size()) return {Token::Kind::end, {}, at_};
    switch (text_[at_]) {
      case ';':
      case '\n': return mark(Token::Kind::separator);
      case '{': return mark(Token::Kind::open);
      case '}': return mark(Token::Kind::close);
      default: break;
    }
    const std::size_t begin = at_;
    while (at_ < text_.size() && !ends_word(text_[at_])) ++at_;
    return {Token::Kind::word, slice(text_, begin, at_ - begin), begin};
  }

  // All that the command goes on with from this word on, blanks included, for a ring tone. There a
  // `#` at the beginning of a word is a comment too, except where it can be a sharp: after a comma
  // or colon, and before one, a dot or an octave. The lexer goes on after it.
  constexpr Token rest_of_command(const Token& first) {
    std::size_t end = first.position;
    char before = ' ';
    for (at_ = first.position; at_ < text_.size() && !ends_command(text_[at_]); ++at_) {
      if (is_blank(text_[at_])) continue;
      if (text_[at_] == '#' && end < at_ && before != ',' && before != ':' && !is_sharp()) break;
      before = text_[at_];
      end = at_ + 1;
    }
    return {Token::Kind::word, slice(text_, first.position, end - first.position), first.position};
  }

 private:
  static constexpr bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r'; }
  static constexpr bool ends_command(char c) {
    return c == ';' || c == '\n' || c == '{' || c == '}';
  }
  static constexpr bool ends_word(char c) { return is_blank(c) || ends_command(c); }
  // Whether what follows the `#` here can follow a sharp.
  constexpr bool is_sharp() const {
    std::size_t next = at_ + 1;
    while (next < text_.size() && is_blank(text_[next])) ++next;
    if (next == text_.size() || ends_command(text_[next])) return true;
    return text_[next] == ',' || text_[next] == '.' || (text_[next] >= '0' && text_[next] <= '9');
  }
  constexpr Token mark(Token::Kind kind) {
    ++at_;
    return {kind, slice(text_, at_ - 1, 1), at_ - 1};
  }
  constexpr void skip_blanks() {
    while (at_ < text_.size() && is_blank(text_[at_])) ++at_;
    if (at_ == text_.size() || text_[at_] != '#') return;
    while (at_ < text_.size() && text_[at_] != '\n') ++at_;
  }

  std::string_view text_;
  std::size_t at_ = 0;
};

}  // namespace cargobay::oi
