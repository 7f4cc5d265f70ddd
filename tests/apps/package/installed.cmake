# Installs the build into a folder of its own, builds the examples against that alone, and runs what came out.
# cmake -DBUILD=… -DSOURCE=… -DWORK=… [-DPYTHON=…] -P installed.cmake
function(run)
  cmake_parse_arguments(arg "" "PRINTS" "COMMAND" ${ARGN})
  execute_process(COMMAND ${arg_COMMAND} RESULT_VARIABLE status OUTPUT_VARIABLE out ERROR_VARIABLE err)
  if(NOT status EQUAL 0)
    message(FATAL_ERROR "${arg_COMMAND} ended with ${status}:\n${out}${err}")
  endif()
  if(DEFINED arg_PRINTS AND NOT out MATCHES "${arg_PRINTS}")
    message(FATAL_ERROR "${arg_COMMAND}: expected '${arg_PRINTS}', got\n${out}${err}")
  endif()
endfunction()

file(REMOVE_RECURSE ${WORK})
unset(ENV{CLEARWAY_DATASETS})
set(prefix ${WORK}/installed)
run(COMMAND ${CMAKE_COMMAND} --install ${BUILD} --prefix ${prefix})

# The program finds its robots and suites beside it.
run(COMMAND ${prefix}/bin/clearway robots PRINTS "puma560")
file(WRITE ${WORK}/point.pcd "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 1\nHEIGHT 1\n\
VIEWPOINT 0 0 0 1 0 0 0\nPOINTS 1\nDATA ascii\n1 2 3\n")
run(COMMAND ${prefix}/bin/clearway inspect ${WORK}/point.pcd PRINTS "1 to 1.02 m")  # by clearway-full
run(COMMAND ${prefix}/bin/clearway --version PRINTS "^clearway [0-9]+\\.[0-9]+\\.[0-9]+( \\([0-9a-f]+\\))?\n$")
file(MAKE_DIRECTORY ${WORK}/quick)  # called like the suite, as after a comparison
execute_process(COMMAND ${prefix}/bin/clearway compare quick --out again WORKING_DIRECTORY ${WORK}
  RESULT_VARIABLE status OUTPUT_VARIABLE out ERROR_VARIABLE err)
if(NOT status EQUAL 0 OR NOT out MATCHES "valid")
  message(FATAL_ERROR "compare quick ended with ${status}:\n${out}${err}")
endif()
foreach(file share/man/man1/clearway.1.gz share/bash-completion/completions/clearway
    share/zsh/vendor-completions/_clearway share/clearway/suites/quick.yaml include/clearway/mapping/snapshot.hpp
    share/doc/clearway/datasets/FORMATS.md share/doc/clearway/apps/OUTPUTS.md share/doc/clearway/LICENSE)
  if(NOT EXISTS ${prefix}/${file})
    message(FATAL_ERROR "not installed: ${file}")
  endif()
endforeach()
include(${SOURCE}/apps/package/page_links.cmake)
file(GLOB_RECURSE pages ${prefix}/*.md)
foreach(page ${pages})
  page_links(${page} links)
  cmake_path(GET page PARENT_PATH folder)
  foreach(link ${links})
    if(NOT EXISTS ${folder}/${link})
      message(FATAL_ERROR "${page} links to ${link}, which is not installed")
    endif()
  endforeach()
endforeach()
file(WRITE ${WORK}/complete.sh "source ${prefix}/share/bash-completion/completions/clearway
COMP_WORDS=(clearway pl)
COMP_CWORD=1
_clearway
echo \${COMPREPLY[*]}
")
run(COMMAND bash ${WORK}/complete.sh PRINTS "^plan planners\n$")

# The Python module finds its libraries and robots as installed.
if(PYTHON)
  set(ENV{PYTHONPATH} ${prefix}/lib/python3/dist-packages)
  run(COMMAND ${PYTHON} -c "from clearway import __file__ as file, datasets_folder\nprint(file, datasets_folder())"
    PRINTS "^${prefix}/lib/python3/dist-packages/clearway/__init__.py ${prefix}/share/clearway\n$")
  file(GLOB scripts ${SOURCE}/apps/examples/python/*.py)
  foreach(script ${scripts})
    run(COMMAND ${PYTHON} ${script} PRINTS "as expected\n$")
  endforeach()
endif()

# Headers and libraries serve somebody else's project. Every header is there, and none needs the source tree.
file(GLOB_RECURSE headers RELATIVE ${prefix}/include/clearway ${prefix}/include/clearway/*.hpp)
list(REVERSE headers)  # so that a header that leans on one before it in the alphabet is found
list(TRANSFORM headers REPLACE "(.+)" "#include \"\\1\"")
list(JOIN headers "\n" includes)
file(WRITE ${WORK}/headers/every_header.cpp "${includes}\nint main() {}\n")
file(WRITE ${WORK}/headers/CMakeLists.txt "cmake_minimum_required(VERSION 3.25)\nproject(every_header LANGUAGES C CXX)\n\
find_package(clearway 0.2 REQUIRED)\nadd_executable(every_header every_header.cpp)\ntarget_link_libraries(every_header PRIVATE\n\
  clearway::mapping clearway::planning clearway::tracking clearway::datasets)\n\
add_library(poses STATIC poses.cpp)\ntarget_link_libraries(poses PRIVATE Eigen3::Eigen)\n\
add_executable(reads_poses reads_poses.cpp)\ntarget_link_libraries(reads_poses PRIVATE poses clearway::mapping)\n\
foreach(target poses reads_poses)\n  target_compile_options(\${target} PRIVATE \${AVX})\nendforeach()\n")
# A library beside ours, and a program of both: they agree on where a pose lies, whatever they are compiled for.
file(WRITE ${WORK}/headers/poses.hpp "#include <Eigen/Geometry>\nstruct Stamped { char stamp; Eigen::Isometry3d pose; };\n\
Stamped seventh();\n")
file(WRITE ${WORK}/headers/poses.cpp "#include \"poses.hpp\"\nStamped seventh() {\n\
  return {1, Eigen::Isometry3d(Eigen::Translation3d(7, 0, 0))};\n}\n")
file(WRITE ${WORK}/headers/reads_poses.cpp "#include \"poses.hpp\"\n#include \"mapping/voxels/sphere.hpp\"\n#include <iostream>\n\
int main() { std::cout << seventh().pose.translation().x(); }\n")
# The examples are compiled for another instruction set: what both sides share must not depend on it.
file(STRINGS /proc/cpuinfo avx REGEX "^flags.* avx " LIMIT_COUNT 1)
if(avx)
  set(for_avx -mavx)
endif()
foreach(project headers examples)
  set(source ${WORK}/headers)
  set(flags -Wall)
  if(project STREQUAL examples)
    set(source ${SOURCE}/apps/examples)
    string(APPEND flags " ${for_avx}")
  endif()
  run(COMMAND ${CMAKE_COMMAND} -G Ninja -S ${source} -B ${WORK}/${project}/build -DCMAKE_PREFIX_PATH=${prefix}
    -DCMAKE_CXX_FLAGS=${flags} -DCMAKE_COMPILE_WARNING_AS_ERROR=ON "-DAVX=${for_avx}")
  run(COMMAND ${CMAKE_COMMAND} --build ${WORK}/${project}/build)
endforeach()
run(COMMAND ${WORK}/headers/build/reads_poses PRINTS "^7$")
# They find the robots of the package that they were built with; another folder may be named.
file(GLOB examples ${SOURCE}/apps/examples/*.cpp)
foreach(example ${examples})
  get_filename_component(name ${example} NAME_WE)
  run(COMMAND ${WORK}/examples/build/${name} PRINTS ".")
endforeach()

set(ENV{CLEARWAY_DATASETS} ${WORK}/headers)
set(example ${WORK}/examples/build/03_plan_and_check)
execute_process(COMMAND ${example} RESULT_VARIABLE status OUTPUT_VARIABLE out ERROR_VARIABLE out)
if(status EQUAL 0 OR NOT out MATCHES "expected a folder that holds a folder 'robots'")
  message(FATAL_ERROR "${example} with another CLEARWAY_DATASETS ended with ${status}:\n${out}")
endif()
unset(ENV{CLEARWAY_DATASETS})

# Another project may take in the sources as well.
run(COMMAND ${CMAKE_COMMAND} -G Ninja -S ${SOURCE}/tests/apps/package/as_subproject -B ${WORK}/as_subproject
  -DCLEARWAY_SOURCE=${SOURCE})
