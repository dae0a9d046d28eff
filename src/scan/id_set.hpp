#pragma once
// A set of ids as runs of successive ones: a grid of a million points is a few of them.

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <map>
#include <span>

namespace rodwake::scan {

class IdSet {
public:
    bool contains(std::int64_t id) const {
        const auto after = runs_.upper_bound(id);
        return after != runs_.begin() && std::prev(after)->second >= id;
    }

    std::int64_t size() const { return size_; }

    /// Ids in increasing order; those that are there already change nothing.
    void insert(std::span<const std::int64_t> ids) {
        for (std::size_t i = 0; i < ids.size();) {
            std::size_t end = i + 1;
            while (end < ids.size() && ids[end] == ids[end - 1] + 1)
                ++end;
            insert(ids[i], ids[end - 1]);
            i = end;
        }
    }

    template<class Each>
    void for_each(const Each& each) const {
        for (const auto& [first, last] : runs_)
            for (std::int64_t id = first; id <= last; ++id)
                each(id);
    }

private:
    /// All of first..last, joined with the runs that it overlaps or touches.
    void insert(std::int64_t first, std::int64_t last) {
        auto at = runs_.upper_bound(first);
        if (at != runs_.begin() && std::prev(at)->second >= first - 1)
            --at;
        while (at != runs_.end() && at->first <= last + 1) {
            first = std::min(first, at->first);
            last = std::max(last, at->second);
            size_ -= at->second - at->first + 1;
            at = runs_.erase(at);
        }
        runs_.emplace_hint(at, first, last);
        size_ += last - first + 1;
    }

    std::map<std::int64_t, std::int64_t> runs_; ///< first and last
    std::int64_t size_ = 0;
};

} // namespace rodwake::scan
