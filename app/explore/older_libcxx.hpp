#pragma once
// What the kernels use of C++20 and Debian's emscripten (libc++ of LLVM 14) lacks. Included before every
// source of the page's kernels by tools/explorer; no other build sees it.

#include <algorithm>
#include <functional>
#include <type_traits>

namespace std {

template<class To, class From>
constexpr To bit_cast(const From& from) {
    return __builtin_bit_cast(To, from);
}

namespace ranges {

template<class Range, class Predicate>
constexpr bool any_of(const Range& range, Predicate wanted) {
    for (const auto& item : range)
        if (std::invoke(wanted, item))
            return true;
    return false;
}

template<class Range, class Predicate>
constexpr bool all_of(const Range& range, Predicate wanted) {
    return !any_of(range, [&](const auto& item) { return !std::invoke(wanted, item); });
}

template<class Range, class Value, class Projection>
constexpr auto find(const Range& range, const Value& value, Projection projection) {
    auto at = std::begin(range);
    while (at != std::end(range) && !(std::invoke(projection, *at) == value))
        ++at;
    return at;
}

template<class Range, class Out>
constexpr Out copy(const Range& range, Out out) {
    return std::copy(std::begin(range), std::end(range), out);
}

template<class Range, class... Order>
constexpr void sort(Range&& range, Order... order) {
    std::sort(std::begin(range), std::end(range), order...);
}

template<class Range>
constexpr auto minmax(const Range& range) {
    const auto both = std::minmax_element(std::begin(range), std::end(range));
    struct Both {
        std::remove_cvref_t<decltype(*both.first)> min, max;
    };
    return Both{*both.first, *both.second};
}

} // namespace ranges
} // namespace std
