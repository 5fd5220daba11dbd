#pragma once
// Rows of splat files that no program can draw. Other trainers leave a few of them behind, which is no reason to refuse
// all others.

#include <string>
#include <vector>

#include "oraclegs/gaussians/gaussians.h"
#include "oraclegs/gaussians/selection.h"

namespace oraclegs {

/// Makes what a file holds fit to be drawn; the Gaussians are on the host. An infinite logit of an opacity becomes
/// +-15; a standard deviation of 0, whose logarithm is minus infinity, 1e-30; a quaternion whose square is no float
/// gets length 1, and one of zeros is taken for the identity. Gaussians with any other number that is not finite are
/// left out, with their marks. Everything left out or assumed is added to `warnings`, a line each that names `file`.
/// Throws InputError when more than one Gaussian in ten would be left out.
void LeaveOutDamaged(const std::string& file, Gaussians* gaussians, GaussianMarks* marks,
                     std::vector<std::string>* warnings);

}  // namespace oraclegs
