// Proves the certificate of a packed asset again (core/certificate.h).
#pragma once

#include <functional>
#include <string>

#include "pipeline/check/report.h"
#include "pipeline/options/settings.h"

namespace cloudbake {

/// Computes the bound from the file's integers and compares it with the recorded one and with 1/255; nothing else of the asset is judged.
/// With settings.judge.against it also measures the largest difference of T from that asset, which must stay within the bound.
CheckReport checkCertificate(const Settings& settings, const std::function<void(const std::string&)>& on_stage);

}  // namespace cloudbake
