# Prints the cmocka tests that reach no assertion, neither themselves nor through functions and macros of the files given:
# a test that asserts nothing proves nothing. Give it every source and header of the tests.
# A name belongs to its test program, or, if a file that is none defines it, to all.

function begin(line) {
    if (!match(line, /[A-Za-z_][A-Za-z0-9_]*\(/)) return
    name = substr(line, RSTART, RLENGTH - 1)
    if (program != "") name = program SUBSEP name
    if (!(name in body)) order[++count] = name
    owner[name] = program
    body[name] = body[name] substr(line, RSTART + RLENGTH)
    if (line ~ /^static void .*\(void \*\*/ && program != "") {
        place[name] = FILENAME ":" FNR
        tests[FILENAME]++
    }
}

FNR == 1 {
    name = ""
    macro = 0
    program = FILENAME ~ /test_[^\/]*\.c$/ ? FILENAME : ""
    if (program != "") programs[program] = 1
}

# A macro lasts as long as its lines end in a backslash.
name == "" && /^#[ \t]*define [A-Za-z_][A-Za-z0-9_]*\(/ { begin(substr($0, index($0, "define ") + 7)); macro = 1 }
macro { body[name] = body[name] "\n" $0; if ($0 !~ /\\$/) { macro = 0; name = "" }; next }

# A function begins with a word in the first column and ends with a brace there.
/^[A-Za-z].*\(/ && !/;[ \t]*$/ { begin($0) }
name != "" { body[name] = body[name] "\n" $0 }
/^}/ || /^[A-Za-z].*}[ \t]*$/ { name = "" }

END {
    for (i = 1; i <= count; i++)
        if (body[order[i]] ~ /(assert_[a-z_]+|fail_msg|fail)\(/) asserts[order[i]] = 1

    # Whoever calls one that asserts, asserts.
    do {
        changed = 0
        for (i = 1; i <= count; i++) {
            if (order[i] in asserts) continue
            text = body[order[i]]
            while (match(text, /[A-Za-z_][A-Za-z0-9_]*/)) {
                word = substr(text, RSTART, RLENGTH)
                if (word in asserts || (owner[order[i]] SUBSEP word) in asserts) {
                    asserts[order[i]] = 1
                    changed = 1
                    break
                }
                text = substr(text, RSTART + RLENGTH)
            }
        }
    } while (changed)

    for (i = 1; i <= count; i++)
        if (order[i] in place && !(order[i] in asserts)) {
            split(order[i], part, SUBSEP)
            printf "%s: %s asserts nothing\n", place[order[i]], part[2]
        }
    for (program in programs)
        if (!tests[program]) printf "%s: has no test\n", program
}
