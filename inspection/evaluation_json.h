// The part of result.json that comes from all views together.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "inspection/evaluation.h"

namespace trueblade {

// Pieces shared with other documents. Numbers that do not exist are null.
nlohmann::ordered_json number_json(double value);
nlohmann::ordered_json vector_json(const Vec3& v);
nlohmann::ordered_json pose_json(const RigidTransform& pose);
nlohmann::ordered_json undetermined_json(const RegistrationResult& registration);  // in words
// The scatter behind the covariance, and what the search for closest points cost.
nlohmann::ordered_json registration_work_json(const RegistrationResult& registration);
nlohmann::ordered_json covariance_json(const Eigen::Ref<const Eigen::MatrixXd>& covariance);
nlohmann::ordered_json statistics_json(const DeviationStatistics& statistics);
nlohmann::ordered_json tolerance_json(const Tolerance& tolerance);
// {within, over, under, outliers_outside, percent_within, percent_over, percent_under}
nlohmann::ordered_json counts_json(const ToleranceCounts& counts);

// The keys datum_surfaces, joint, profiles, sections, groups, offsets, missing and missing_features.
nlohmann::ordered_json evaluation_json(const EvaluationResult& evaluation);

}  // namespace trueblade
