#pragma once

#include "city/model/CityModel.h"
#include "reflection/truth/TriangleTracer.h"

namespace app {

/// Adds everything that stands in a city, as fine as it gets, to a tracer that is not yet committed.
void addCity(reflection::TriangleTracer& tracer, const city::CityModel& city);

}  // namespace app
