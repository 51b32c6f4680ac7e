// Findings about a picture of a robot. Pure: the same for the same picture.
//
//     const auto picture = doctor::look({.participant = options});     // look.h
//     for (const doctor::Finding& finding : doctor::examine(*picture)) print(finding);
//
// A finding is a claim that something is wrong, and a false one is a bug: where what was seen has
// an innocent explanation that the picture does not rule out, nothing is found. finding_explanations.h says
// of each code when it is reported, and when not.
#pragma once

#include <vector>

#include "doctor/finding.h"
#include "doctor/picture.h"

namespace culprit::doctor {

// The worst first, then by code and name.
std::vector<Finding> examine(const Picture& picture);

// Sorts, and removes duplicates.
void put_worst_first(std::vector<Finding>& findings);

// Its parts. Each adds what it finds.
using Findings = std::vector<Finding>;
void examine_connections(const Picture& picture, Findings& all);  // D001 to D009: who hears whom
void examine_nodes(const Picture& picture, Findings& all);        // D010 to D016
void examine_processes(const Picture& picture, Findings& all);    // D014, D017 to D019
void examine_statuses(const Picture& picture, Findings& all);     // D020, D021: diagnostics
void examine_reach(const Picture& picture,
                   Findings& all);  // D030 to D036: who can hear whom at all
void examine_flows(const Picture& picture, Findings& all);       // D040 to D048: messages and time
void examine_transforms(const Picture& picture, Findings& all);  // D050 to D054: tf
void examine_disks(const Picture& picture, Findings& all);       // D060

}  // namespace culprit::doctor
