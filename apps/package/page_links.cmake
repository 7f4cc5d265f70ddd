# page_links(FILE RESULT): what the relative links of a page name, as they stand there, without places inside of pages.
# Code is no link.
function(page_links file result)
  file(READ ${file} text)
  string(REPLACE ";" "," text "${text}")
  string(REGEX REPLACE "`[^`]*`" "" text "${text}")
  string(REPLACE "](" "\nlink:" text "${text}")  # no brackets, which CMake's lists would take for their own
  string(REGEX MATCHALL "link:[^]\n#() ]+" links "${text}")
  list(TRANSFORM links REPLACE "^link:" "")
  list(FILTER links EXCLUDE REGEX "^[a-z]+:")
  list(REMOVE_DUPLICATES links)
  set(${result} ${links} PARENT_SCOPE)
endfunction()
