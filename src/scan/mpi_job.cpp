#include "rodwake/core/error.hpp"
#include "rodwake/scan/mpi.hpp"
#include "work_queue.hpp"

#include <fmt/format.h>
#include <mpi.h>

#include <chrono>
#include <cstdlib>
#include <future>
#include <string_view>
#include <thread>

namespace rodwake::scan {

namespace {

enum Tag : int { points_tag = 1, results_tag = 2, home_tag = 3, failure_tag = 4 };

/// Rank 0's core also computes: at 50 us the waking up alone took a tenth of it. A chunk takes 10 ms.
constexpr std::chrono::microseconds poll(200);

template<class T>
std::vector<T> receive(const MPI_Status& status) {
    int bytes = 0;
    MPI_Get_count(&status, MPI_BYTE, &bytes);
    std::vector<T> items(static_cast<std::size_t>(bytes) / sizeof(T));
    MPI_Recv(items.data(), bytes, MPI_BYTE, status.MPI_SOURCE, status.MPI_TAG, MPI_COMM_WORLD,
             MPI_STATUS_IGNORE);
    return items;
}

template<class T>
void send(std::span<const T> items, int to, Tag tag) {
    MPI_Send(items.data(), static_cast<int>(items.size_bytes()), MPI_BYTE, to, tag, MPI_COMM_WORLD);
}

} // namespace

/// The other ranks as rank 0 sees them.
struct MpiJob::Workers {
    std::vector<int> idle;
    int busy = 0;
    std::string failure; ///< of the first rank that reported one

    /// Results that have arrived; false: none.
    bool collect(std::vector<Result>& results) {
        MPI_Status status;
        int there = 0;
        MPI_Iprobe(MPI_ANY_SOURCE, MPI_ANY_TAG, MPI_COMM_WORLD, &there, &status);
        if (there == 0)
            return false;
        if (status.MPI_TAG == failure_tag) {
            // The rank is gone, with a chunk or without.
            const std::vector<char> text = receive<char>(status);
            if (failure.empty())
                failure =
                    fmt::format("rank {}: {}", status.MPI_SOURCE, std::string(text.begin(), text.end()));
            busy -= std::erase(idle, status.MPI_SOURCE) == 0;
            return false;
        }
        results = receive<Result>(status);
        idle.push_back(status.MPI_SOURCE);
        --busy;
        return true;
    }
};

std::unique_ptr<MpiJob> MpiJob::join() {
    return started_as_rank() ? std::unique_ptr<MpiJob>(new MpiJob) : nullptr;
}

MpiJob::MpiJob() {
    // Open MPI's libraries for networks with matching hardware wait 0.2 s for devices that are not there;
    // ranks on one machine share memory. What the environment or mpiexec sets stays; openmpi-mca-params.conf
    // does not.
    const char *all = std::getenv("OMPI_COMM_WORLD_SIZE"), *here = std::getenv("OMPI_COMM_WORLD_LOCAL_SIZE");
    if (all && here && std::string_view(all) == here)
        setenv("OMPI_MCA_pml", "^cm", 0);
    int provided = 0;
    MPI_Init_thread(nullptr, nullptr, MPI_THREAD_FUNNELED, &provided);
    MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
    MPI_Comm_size(MPI_COMM_WORLD, &ranks_);
    workers_ = std::make_unique<Workers>();
    for (int other = ranks_ - 1; rank_ == 0 && other > 0; --other)
        workers_->idle.push_back(other);
}

MpiJob::~MpiJob() {
    std::vector<Result> late;
    while (workers_->busy > 0) // an exception on rank 0 left them at it
        if (!workers_->collect(late))
            std::this_thread::sleep_for(poll);
    for (const int other : workers_->idle)
        send(std::span<const Point>(), other, home_tag);
    MPI_Finalize();
}

Execute MpiJob::executor(Evaluate evaluate, std::function<bool()> stop) {
    return [this, evaluate = std::move(evaluate), stop = std::move(stop)](std::span<const Point> points,
                                                                          const Take& take) {
        WorkQueue queue(points, take, static_cast<std::size_t>(ranks_), stop);
        // this thread talks to the others, another one of this rank computes
        std::future<void> own = std::async(std::launch::async, [&] {
            try {
                work(queue, evaluate);
            } catch (...) {
                queue.stop();
                throw;
            }
        });
        try {
            std::vector<Result> results;
            do {
                while (!workers_->idle.empty()) { // each gets a chunk, as long as there are any
                    const auto chunk = queue.next();
                    if (chunk.empty())
                        break;
                    send(chunk, workers_->idle.back(), points_tag);
                    workers_->idle.pop_back();
                    ++workers_->busy;
                }
                if (workers_->collect(results))
                    queue.take(results);
                else if (!workers_->failure.empty())
                    throw RunError(workers_->failure);
                else
                    std::this_thread::sleep_for(poll);
            } while (workers_->busy > 0 ||
                     own.wait_for(std::chrono::seconds(0)) != std::future_status::ready);
        } catch (...) {
            queue.stop();
            own.wait();
            throw;
        }
        own.get();
        return !queue.stopped();
    };
}

void MpiJob::serve(const Evaluate& evaluate) {
    std::vector<Result> results;
    for (;;) {
        MPI_Status status;
        // MPI waits by spinning; ranks that share cores with computing ones must not.
        for (int there = 0; there == 0;) {
            MPI_Iprobe(0, MPI_ANY_TAG, MPI_COMM_WORLD, &there, &status);
            if (there == 0)
                std::this_thread::sleep_for(poll);
        }
        const std::vector<Point> points = receive<Point>(status);
        if (status.MPI_TAG == home_tag)
            return;
        results.assign(points.size(), {});
        evaluate(points, results);
        send(std::span<const Result>(results), 0, results_tag);
    }
}

void MpiJob::fail(const std::string& why) {
    send(std::span<const char>(why.data(), std::min<std::size_t>(why.size(), 2000)), 0, failure_tag);
}

} // namespace rodwake::scan
