# Doxygen's view of a public header: the comment at the top becomes the file's description as it stands, indented formulas keep
# their lines, <k> in words is no tag. The number of lines stays.
/^#pragma once/ { print "/** \\file"; top = 1; begin = "\\verbatim "; next }
top && /^\/\// { sub(/^\/\/ ?/, ""); print begin $0; begin = ""; next }
top { print (begin ? "*/ " : "\\endverbatim */ ") $0; top = 0; next }
match($0, /\/\/\/.*/) {
    code = substr($0, 1, RSTART - 1); words = substr($0, RSTART + 3)
    formula = words ~ /^   +[^ ]/ && (blank || formula); blank = words ~ /^ *$/
    sign = sub(/^</, "", words) ? "///<" : "///"
    if (formula) words = "    " words; else gsub(/</, "\\<", words)
    print code sign words; next
}
{ blank = formula = 0; print }
