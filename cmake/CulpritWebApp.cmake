# The web app: ui/ -> one C++ file that holds it, compressed.
#
# What npm installs is shared by all presets, in build/ui, where the sources keep clean of it. Where npm is not installed
# the program is built without the app, and says so to whoever asks for it.
find_program(CULPRIT_NPM npm)
find_program(CULPRIT_NODE node)

set(CULPRIT_UI_MODULES ${PROJECT_SOURCE_DIR}/build/ui)

# culprit_web_app(<target>): adds web::app() to it (web/app.h), and installs the licences of what is in it.
function(culprit_web_app target)
  set(ui ${PROJECT_SOURCE_DIR}/ui)
  set(generated ${CMAKE_BINARY_DIR}/ui/app.cpp)
  set(notices ${CMAKE_BINARY_DIR}/ui/web-app-notices.txt)
  if(CULPRIT_WALLS OR NOT CULPRIT_NPM OR NOT CULPRIT_NODE)
    if(NOT CULPRIT_WALLS)
      message(WARNING "npm is not installed: culprit is built without its web app")
    endif()
    file(WRITE ${generated} "#include \"web/app.h\"\nstd::span<const culprit::http::Asset> culprit::web::app() { return {}; }\n")
    target_sources(${target} PRIVATE ${generated})
    return()
  endif()
  file(MAKE_DIRECTORY ${CULPRIT_UI_MODULES})
  file(GLOB sources CONFIGURE_DEPENDS ${ui}/src/* ${PROJECT_SOURCE_DIR}/rules/cookbook/*.rules ${PROJECT_SOURCE_DIR}/rules/packs/*.rules ${PROJECT_SOURCE_DIR}/docs/glossary.md)
  set(installed ${CULPRIT_UI_MODULES}/node_modules/.package-lock.json) # npm's own
  add_custom_command(
    OUTPUT ${installed}
    DEPENDS ${ui}/package.json ${ui}/package-lock.json
    COMMAND ${CMAKE_COMMAND} -E copy ${ui}/package.json ${ui}/package-lock.json ${CULPRIT_UI_MODULES}
    COMMAND ${CULPRIT_NPM} ci --no-audit --no-fund --loglevel=error
    COMMAND ${CMAKE_COMMAND} -E touch ${installed}
    WORKING_DIRECTORY ${CULPRIT_UI_MODULES}
    COMMENT "Installing what the web app is made of")
  add_custom_command(
    OUTPUT ${generated} ${notices}
    DEPENDS ${installed} ${sources} ${ui}/build.mjs ${ui}/bundle.mjs ${ui}/notices.mjs ${ui}/tsconfig.json
    COMMAND ${CULPRIT_NODE} ${ui}/build.mjs ${CULPRIT_UI_MODULES} ${generated} ${notices}
    COMMENT "Bundling the web app")
  target_sources(${target} PRIVATE ${generated})
  install(FILES ${notices} DESTINATION share/doc/culprit COMPONENT culprit)
  set_source_files_properties(${generated} PROPERTIES COMPILE_OPTIONS -Wno-overlength-strings)
  if(CULPRIT_TESTS)
    # esbuild leaves types out; this looks at them.
    add_test(NAME WebApp.HasNoTypeErrors COMMAND ${CULPRIT_NODE} ${CULPRIT_UI_MODULES}/node_modules/typescript/bin/tsc -p ${ui})
    set_tests_properties(WebApp.HasNoTypeErrors PROPERTIES LABELS live)
  endif()
endfunction()
