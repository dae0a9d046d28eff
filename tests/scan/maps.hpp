#pragma once
// Maps whose answer is known, scans of them, and what must hold of a scan whatever was scanned.

#include "rodwake/scan/run.hpp"
#include "store/scratch.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <map>
#include <mutex>
#include <set>

namespace scan_test {

using namespace rodwake::scan;
using store_test::Scratch;
using At = std::array<double, max_axes>;
/// Outcome of a place: 0, 1, 2; -1: the point fails.
using Map = std::function<int(const At&)>;

inline const Columns columns{{"in", "out", "else"}, {"sum", "product"}};

inline Axis axis(std::string name, double from, double to, long count) {
    Axis made;
    made.name = std::move(name);
    made.from = from;
    made.to = to;
    made.count = count;
    return made;
}

/// Axes x, y, z over [-1, 1]; z is the last.
inline Design adaptive(std::size_t axes, long count, long resolution) {
    Design design;
    design.kind = Kind::adaptive;
    for (std::size_t k = 0; k < axes; ++k)
        design.axes.push_back(axis(std::string(1, static_cast<char>('x' + k)), -1.0, 1.0, count));
    design.resolution = resolution;
    return design;
}

inline Design grid(long count_x, long count_y) {
    Design design;
    design.axes = {axis("x", -1.0, 1.0, count_x), axis("y", -1.0, 1.0, count_y)};
    return design;
}

inline Map circle(double radius, double x = 0.0, double y = 0.0) {
    return [=](const At& at) { return std::hypot(at[0] - x, at[1] - y) < radius ? 0 : 1; };
}

/// Inside where `distance` of the line nx x + ny y = c is less than half the width.
inline Map strip(double nx, double ny, double c, double width) {
    return [=](const At& at) {
        return std::abs(nx * at[0] + ny * at[1] - c) < 0.5 * width * std::hypot(nx, ny) ? 0 : 1;
    };
}

inline Result result_of(const Map& map, const Point& point) {
    Result result;
    result.point = point;
    result.outcome = map(point.at);
    if (result.outcome < 0) {
        result.status = Status::failed;
        result.set_cause("no outcome here");
        return result;
    }
    result.values[0] = point.at[0] + point.at[1];
    result.values[1] = point.at[0] * point.at[1];
    return result;
}

/// How often each point was evaluated.
class Tally {
public:
    void add(std::int64_t id) {
        const std::lock_guard lock(mutex_);
        ++times_[id];
    }
    std::set<std::int64_t> ids() const {
        std::set<std::int64_t> found;
        for (const auto& [id, times] : times_)
            found.insert(id);
        return found;
    }
    int most() const {
        int most = 0;
        for (const auto& [id, times] : times_)
            most = std::max(most, times);
        return most;
    }
    std::size_t size() const { return times_.size(); }

private:
    std::mutex mutex_;
    std::map<std::int64_t, int> times_;
};

inline Evaluate evaluate(Map map, Tally* tally = nullptr) {
    return [map = std::move(map), tally](std::span<const Point> points, std::span<Result> results) {
        for (std::size_t i = 0; i < points.size(); ++i) {
            results[i] = result_of(map, points[i]);
            if (tally)
                tally->add(points[i].id);
        }
    };
}

/// Chunks of so many points, one after the other; stops before chunk number `chunks` of all calls.
struct Counter {
    std::size_t chunk = 7;
    long chunks = -1; ///< -1: never stops

    Execute operator()(Evaluate one) {
        return [this, one = std::move(one)](std::span<const Point> points, const Take& take) {
            for (std::size_t first = 0; first < points.size(); first += chunk) {
                if (chunks-- == 0)
                    return false;
                const auto part = points.subspan(first, std::min(chunk, points.size() - first));
                std::vector<Result> results(part.size());
                one(part, results);
                take(results);
            }
            return true;
        };
    }
};

inline LedgerHead head_of(const Design& design, std::string description = "a scan") {
    return {std::move(description), design.axes, columns};
}

/// A scan in memory of its own: runs it to the end, or until its executor stops.
inline Summary run_scan(const Design& design, const std::filesystem::path& file, const Execute& execute,
                        const RunOptions& options = {}) {
    Ledger ledger(file, head_of(design));
    return run(design, ledger, execute, options);
}

inline Summary run_scan(const Design& design, const std::filesystem::path& file, const Map& map,
                        Tally* tally = nullptr) {
    Counter counter{1000};
    return run_scan(design, file, counter(evaluate(map, tally)));
}

/// A row as text, without the time it took.
inline std::string text_of(const Result& r, std::size_t axes) {
    std::string text = std::to_string(r.point.id);
    for (std::size_t k = 0; k < axes; ++k)
        text += " " + std::to_string(std::bit_cast<std::uint64_t>(r.point.at[k]));
    text += " " + std::to_string(r.ok() ? r.outcome : -1) + " " +
            status_names[static_cast<std::size_t>(r.status)] + " " + std::to_string(r.retries) + " " +
            std::string(r.cause_text());
    for (std::size_t k = 0; r.ok() && k < columns.observables.size(); ++k)
        text +=
            " " + (std::isnan(r.values[k]) ? "-" : std::to_string(std::bit_cast<std::uint64_t>(r.values[k])));
    return text;
}

/// All rows and brackets of a ledger, to the bit; without times.
inline std::vector<std::string> rows_of(const Design& design, const std::filesystem::path& file) {
    const Ledger ledger(file, head_of(design));
    std::vector<std::string> rows;
    ledger.for_each([&](const Result& r) { rows.push_back(text_of(r, design.axes.size())); });
    for (const OutcomeChange& c : ledger.crossings())
        rows.push_back("edge " + std::to_string(c.id) + " " + std::to_string(c.outcome_low) + " " +
                       std::to_string(c.outcome_high) + " " +
                       std::to_string(std::bit_cast<std::uint64_t>(c.u_low)) + " " +
                       std::to_string(std::bit_cast<std::uint64_t>(c.u_high)));
    return rows;
}

inline std::set<std::int64_t> ids_of(const Design& design, const std::filesystem::path& file) {
    const Ledger ledger(file, head_of(design));
    std::set<std::int64_t> ids;
    ledger.for_each_id([&](std::int64_t id) { ids.insert(id); });
    return ids;
}

} // namespace scan_test
