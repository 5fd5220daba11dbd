#pragma once

#include "arrays.h"

namespace oraclegs::python {

void BindRun(py::module_& m);    ///< run.cpp
void BindViews(py::module_& m);  ///< views.cpp

}  // namespace oraclegs::python
