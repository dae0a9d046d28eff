#pragma once
// Which start, density, times and number of runs would tell the rivals of a fit apart: experiments are made
// up before they are done.
//
// For each design every model of the scene in turn makes sets of tracks: parameters from its priors, noise of
// the rods if it has some, errors of sigma_position and sigma_heading. Each set is weighed by all models
// (fitting::curvature_evidence), all equally probable beforehand. The expected information on which model it
// is, in bits, is log2(models) + <log2 p(true model | tracks)>: their mutual information. Sets of equal
// number have the same random numbers in all designs, so that differences between these are known better.
//
// Runs of a design begin alike. Rods that do not diffuse then tell in R runs what they would in one with
// errors smaller by sqrt(R); of others there are R tracks.

#include "rodwake/app/run_context.hpp"
#include "rodwake/scene/scene.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace rodwake::app {

struct DesignRequest {
    std::vector<std::string> vary; ///< "rods.1.position.1=1.5,2,3": all combinations of several
    std::filesystem::path list;    ///< a CSV file instead: keys in the header, a design a row
    std::vector<long> runs = {1};  ///< each design with so many
    long sets = 20;                ///< of tracks by each model
};

struct WeighedDesign {
    std::vector<std::string> settings; ///< "key=value"
    long runs = 1;
    double information = 0.0, error = 0.0; ///< bits, and their standard error
    double right = 0.0;                    ///< share of sets in which the true model has the largest evidence
    /// Mean logarithm of the evidence of the model that made the tracks over that of another one: by both.
    std::vector<std::vector<double>> log_bayes;

    double least_log_bayes() const; ///< of all pairs
};

struct WeighedDesigns {
    std::vector<std::string> models;
    std::vector<WeighedDesign> designs; ///< in their order
    bool finished = true;               ///< false: a signal stopped it

    std::size_t best() const; ///< the most information
};

/// Throws InputError for a scene without rods, rivals or priors, and naming the design that makes no scene.
WeighedDesigns weigh_designs(const scene::Scene& scene, const DesignRequest& request,
                             const RunContext& context);

/// design.csv and design.json.
void write_designs(const WeighedDesigns& found, const DesignRequest& request,
                   const std::filesystem::path& folder, const std::string& command);

} // namespace rodwake::app
