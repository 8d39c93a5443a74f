# The files that make up a report, embedded into loam_experiments (include this after the target is defined).
# A script's name here is the name by which other scripts `require` it.
include(${PROJECT_SOURCE_DIR}/cmake/embed.cmake)

# Debian splits Vega into its modules. These are the ones that Cartesian charts need: no maps, force layouts, word clouds.
set(vega_modules util time format statistics loader dataflow scale canvas scenegraph expression functions event-selector
                 runtime encode transforms view-transforms parser view)
find_path(LOAM_VEGA_DIR vega-util.min.js PATHS /usr/share/javascript/vega NO_DEFAULT_PATH)
if(NOT LOAM_VEGA_DIR)
  message(FATAL_ERROR "Vega, which draws the report's charts, is missing: apt-get install libjs-vega")
endif()
set(report_assets "")
foreach(module IN LISTS vega_modules)
  list(APPEND report_assets vega-${module}=${LOAM_VEGA_DIR}/vega-${module}.min.js)
endforeach()
list(APPEND report_assets vega-selections=${LOAM_VEGA_DIR}/vega-selection.min.js)  # Debian's file lacks the s

foreach(asset template.html style.css page/loader.js
              page/vega.js page/dom.js page/format.js page/chart.js page/marks.js page/phases.js page/test_axes.js
              page/main.js
              sections/header.js sections/parameters.js sections/tests.js sections/test_chart.js sections/crosstest.js sections/joint.js
              sections/posterior.js sections/pairs.js sections/emulator.js sections/emulator_charts.js
              sections/sensitivity.js sections/heat_map.js sections/packing.js sections/quasi_static.js
              sections/bulk_samples.js sections/bulk_groups.js sections/bulk_correlations.js sections/bulk_ensemble.js
              sections/settings.js sections/diagnosis.js sections/atlas.js)
  list(APPEND report_assets ${asset}=${CMAKE_CURRENT_LIST_DIR}/${asset})
endforeach()
loam_embed(TARGET loam_experiments HEADER "experiments/report/assets.hpp"
           FUNCTION loam::experiments::report::embedded_assets ASSETS ${report_assets})
