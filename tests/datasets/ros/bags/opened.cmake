# What `clearway replay --record` writes is opened by @mcap/core, which checks every checksum.
# cmake -DCLEARWAY=… -DWORK=… -P opened.cmake
function(run)
  cmake_parse_arguments(arg "" "OUT" "COMMAND" ${ARGN})
  execute_process(COMMAND ${arg_COMMAND} WORKING_DIRECTORY ${WORK} RESULT_VARIABLE status OUTPUT_VARIABLE out ERROR_VARIABLE err)
  if(NOT status EQUAL 0)
    message(FATAL_ERROR "${arg_COMMAND} ended with ${status}:\n${out}${err}")
  endif()
  set(out "${out}" PARENT_SCOPE)
endfunction()

set(bags ${CMAKE_CURRENT_LIST_DIR})
file(MAKE_DIRECTORY ${WORK})
foreach(file package.json package-lock.json read_record.mjs)
  file(COPY ${bags}/${file} DESTINATION ${WORK})
endforeach()
if(NOT EXISTS ${WORK}/node_modules/@mcap/core)
  run(COMMAND npm ci --no-audit --no-fund)
endif()
file(WRITE ${WORK}/setup.yaml "map: {resolution: 0.05}\nsource: {bag: {clouds: [/points], scans: [/scan], fixed_frame: map}}\n")
run(COMMAND ${CLEARWAY} replay ${bags}/cdr_zstd.mcap --setup ${WORK}/setup.yaml --out ${WORK}/out --record ${WORK}/out.mcap)
run(COMMAND node read_record.mjs out.mcap)
foreach(expected "\"/scans\":8" "\"/voxels/seen_free\":1" "\"/voxels/occupied\":1")
  if(NOT out MATCHES "${expected}")
    message(FATAL_ERROR "expected ${expected}, got ${out}")
  endif()
endforeach()

# Poses of camera, probe and tags against the truth of a simulated stroke.
file(WRITE ${WORK}/stroke_setup.yaml "
camera: {width: 320, height: 240, fx: 330, fy: 331, cx: 158, cy: 121, distortion: [-0.12, 0.05, 0.0005, -0.0004, 0]}
boards:
  - name: base
    map_from_board: [0, 0, 0.001, 0, 0, 0.1]
    tags: [{id: 0, size: 0.05, pose: [0.06, 0.09, 0, 0, 0, -1.5]}, {id: 1, size: 0.05, pose: [0.06, -0.09, 0, 0, 0, -1.5]}]
  - name: probe
    tags: [{id: 10, size: 0.04, pose_deg: [0, 0, 0.025, 0, 0, -90]}, {id: 11, size: 0.04, pose_deg: [-0.025, 0, 0, 90, 0, -90]},
           {id: 12, size: 0.04, pose_deg: [0, -0.025, 0, 90, 0, 0]}]
probe: {board: probe, ball_center: [0, 0, -0.08], ball_radius: 0.02}
")
file(WRITE ${WORK}/scene.yaml "
setup: stroke_setup.yaml
shapes: [{name: table, box: [1, 1, 0.02], pose: [0, 0, -0.01, 0, 0, 0], grey: 170}]
camera: {look_at: {eye: [-0.3, 0.02, 0.36], target: [0.05, 0, 0.05]}, rate_hz: 20, noise_sigma: 1, blur_px: 0.5}
stroke:
  duration: 0.5
  orientation_deg: [0, -15, 18]
  waypoints: [{ball: [0.05, -0.03, 0.06]}, {ball: [0.08, 0, 0.09]}, {ball: [0.05, 0.03, 0.06]}]
")
run(COMMAND ${CLEARWAY} simulate scene.yaml --out ${WORK}/stroke.rawlog)
run(COMMAND ${CLEARWAY} replay stroke.rawlog --resolution 0.005 --out ${WORK}/stroke --record ${WORK}/stroke.mcap)
run(COMMAND node read_record.mjs stroke.mcap truth.json)
foreach(expected "\"/poses/camera\":[1-9]" "\"/poses/probe\":[1-9]" "\"/camera/camera_info\":1[01]")
  if(NOT out MATCHES "${expected}")
    message(FATAL_ERROR "expected ${expected}, got ${out}")
  endif()
endforeach()
