#!/usr/bin/env bash
# The page of --report: it is written completely, its JSON is that of --json, and it needs no
# network. Long form, in Chromium: the four answers of the first screen for a good log, one with an
# input of wrong sign, and one that is too slow. REPORT_FIGURE=write tests/program/test_report.sh
# also writes the figure in README.
. "$(dirname "$0")/common.sh"

template=$ROOT/tools/auvid/report/report.html
check "the program holds tools/auvid/report/report.html as it is" "$ROOT/tools/auvid/embed.py" \
    --check "$ROOT/tools/auvid/report/report_template.c" report_template "$template"

# ---- logs ----
sets=4
[ -n "${AUVID_TEST_LONG:-}${REPORT_FIGURE:-}" ] && sets=8
for seed in 1 2; do
    "$AUVID" demo --sets $sets --disturbance 1 --seed $seed --csv $seed.csv >/dev/null 2>&1
done
mv 1.csv good.csv
# change NAME CODE: good.csv with `rows` edited.
change() {
    python3 -c '
import csv, sys
head, *rows = csv.reader(open("good.csv"))
exec(sys.argv[1])
csv.writer(sys.stdout, lineterminator="\n").writerows([head, *rows])' "$2" >"$1.csv"
}
change sign 'for row in rows: row[head.index("Y_N")] = str(-float(row[head.index("Y_N")]))'
change slow 'rows = rows[::50]'

sed 's/^m_u = mass surge kg$/m_u = mass surge <!-- \&/' \
    "$ROOT/tools/auvid/vehicles/surface.ini" >comment.ini
check "a unit is no markup" sh -c "'$AUVID' demo --vehicle comment.ini --sets 1 \
    --report comment.html >/dev/null 2>&1; [ -s comment.html ] && ! grep -q '<!-- &' comment.html &&
    [ \$(grep -c '</script>' comment.html) -ge 2 ]"

cat >page.py <<'END'
import html, json, re, sys
page = open(sys.argv[1], errors="replace").read()
template = open(sys.argv[2]).read()
result = re.search(r'<script type="application/json" id="result">\n(.*?)</script>', page, re.S)[1]
text = html.unescape(re.search(r'<pre id="text">\n(.*?)</pre>', page, re.S)[1])
command = html.unescape(re.search(r'<pre id="command">\n(.*?)\n</pre>', page, re.S)[1])
d = json.loads(result)
exec(sys.argv[3])
END
# page FILE CODE: runs Python with what the page holds: page, template, result, d, text, command.
page() {
    python3 page.py "$1" "$template" "$2"
}

# same STATUS ARGUMENTS...: the JSON in the page of --report is the output of --json.
same() {
    local wanted=$1
    shift
    exits "$wanted" "$@" --json --report page.html
    page page.html 'assert result == open("out").read(), "JSON differs"'
}
fitted=(good.csv --validate 2.csv --thrusters girona500)
check "the JSON in the page of fit is that of --json" same 0 fit "${fitted[@]}"
check "  and the rest is the template" page page.html '
rest = page.replace(result, "<!--json-->\n", 1)
rest = re.sub(r"(<pre id=\"text\">\n).*?(</pre>)", r"\1<!--text-->\n\2", rest, 1, re.S)
rest = re.sub(r"(<pre id=\"command\">\n).*?(</pre>)", r"\1<!--command-->\n\2", rest, 1, re.S)
assert rest == template'
check "  no address of the network is in it" page page.html '
assert not re.search(r"(https?:|//[a-z]|\b(src|href|url)\b *[=(]|@import)", page.replace(
    "http://www.w3.org/2000/svg", ""))'
check "  without JavaScript it answers in text" page page.html '
known = sum(p["identifiable"] for p in d["parameters"])
assert f"{known} of 13 parameters are identifiable" in text and known > 0
assert "surge: R2 of held-out velocity %.4f" % d["r2_validation"]["u"] in text
assert all(p["name"] in text and p["note"] in text for p in d["parameters"])
assert all(sentence in text for sentence in d["missing"]) and d["missing"]
assert command == ("auvid fit good.csv --validate 2.csv --thrusters girona500 --json "
                   "--report page.html")'
check "  it says which logs it is from" page page.html '
assert d["log"]["paths"] == ["good.csv"] and d["held_out_log"]["paths"] == ["2.csv"]
assert 0.01 < d["log"]["velocity_s"] < 0.21 and d["log"]["gaps"] == 0 and d["log"]["gap_s"] > 0
rows = open("good.csv").read().splitlines()
assert d["log"]["rows"] == len(rows) - 1
assert abs(d["log"]["duration_s"] - float(rows[-1].split(",")[0])
           + float(rows[1].split(",")[0])) < 1e-6'
check "  measured and predicted velocity are those of R2" page page.html '
v = d["velocity"]
assert 300 < len(v["t_s"]) <= 600 and v["t_s"][0] == 0 and sorted(v["t_s"]) == v["t_s"]
for k in "uvwr":
    y, z = v[k]["measured"], v[k]["predicted"]
    mean = sum(y) / len(y)
    r2 = 1 - sum((a - b) ** 2 for a, b in zip(y, z)) / sum((a - mean) ** 2 for a in y)
    assert len(y) == len(z) == len(v["t_s"]) and abs(r2 - d["r2_validation"][k]) < 2e-3, (k, r2)'
check "  half-widths are 2.1 standard errors, and DoF and kind are named" page page.html '
assert all(abs(p["half_width"] / p["sigma"] - 2.1) < 1e-6 for p in d["parameters"])
kinds = {p["name"]: (p["dof"], p["kind"]) for p in d["parameters"]}
assert kinds["m_u"] == ("surge", "mass") and kinds["N_rr"] == ("yaw", "quadratic drag")
assert kinds["m_r"] == ("yaw", "inertia") and kinds["W-B"] == ("heave", "force")'
check "tables are printed as without it" exits 0 fit "${fitted[@]}" --report page.html
cp out with
exits 0 fit "${fitted[@]}"
check "  to the last character" cmp out with
check "the page of demo" same 0 demo --sets 2 --report page.html
check "  has the truth" page page.html 'assert all("truth" in p for p in d["parameters"])'
exits 0 node --bus memory --excite --sets 2 --log dive.log
check "the page of a CAN dive" same 0 replay dive.log --sets 2
check "  says that nothing is wrong with it" page page.html 'assert d["log_findings"] == []'
check "  names the log" page page.html '
assert d["log"]["paths"] == ["dive.log"]
assert abs(d["log"]["duration_s"] / (d["log"]["rows"] - 1) - 0.02) < 1e-4'
check "several logs are one page" same 0 fit good.csv 2.csv --thrusters girona500
check "  names both" page page.html 'assert d["log"]["paths"] == ["good.csv", "2.csv"]'
check "a log with a wrong sign and one without" same 0 fit good.csv sign.csv --thrusters girona500
check "  the wrong one is left out" page page.html 'assert d["log"]["paths"] == ["good.csv"]'
check "  the page says which, and what" page page.html '
one, = d["log_findings"]
assert (one["log"], one["severity"], one["code"]) == ("sign.csv", "error", "input_sign"), one
assert one["sentence"].startswith("Y_N has the wrong sign") and one["sentence"] in text'
check "every model" same 0 fit good.csv --model fossen --plain
check "a log that is too slow: exit 3, and a page" same 3 fit slow.csv
check "  the only advice is to record faster" page page.html '
assert d["missing"] == ["the log: record a row every 0.2 s or more often, without gaps"]
assert d["log_findings"][0]["code"] == "slow" and d["log_findings"][0]["severity"] == "error"
assert d["status"] == "not_excited" and "0 of 13 parameters are identifiable" in text'
hostile=$'a</script><b>&"\'\\ \xff.csv'
mkdir 'a<' && cp good.csv "$hostile"
check "a name of a log cannot break the page" same 0 fit "$hostile" --plain
check "  and is in it" page page.html '
assert d["log"]["paths"][0] == "a</script><b>&\"\x27\\ \ufffd.csv" and page.count("</script>") == 2
assert "<b>&" not in page' 2>/dev/null
check "a page that cannot be written" exits 2 fit good.csv --plain --report none/x.html
check "  is one line on stderr, which names it" grep -qx 'auvid: none/x.html: cannot be .*' err
check "no part of a page is left" test -z "$(compgen -G '*.part')"
for other in "--runs 2" "--scenario payload" "--field 1"; do
    # shellcheck disable=SC2086
    check "--report is of one run: not with $other" refuses 'cannot be combined' \
        demo --report x.html $other
done
check "node has no --report" refuses 'unknown option --report' node --bus memory --report x.html

# ---- in a browser ----
if [ -z "${AUVID_TEST_LONG:-}${REPORT_FIGURE:-}" ]; then
    finish
fi
"$ROOT/tests/support/setup.sh" browser >/dev/null
browse() {
    chromium --headless --no-sandbox --disable-gpu --hide-scrollbars "$@" 2>browser.err
}
cat >shown.py <<'END'
import html, json, re, sys
page = open(sys.argv[1] + ".html").read()
d = json.loads(re.search(r'id="result">\n(.*?)</script>', page, re.S)[1])
dom = open(sys.argv[1] + ".dom").read()
body = re.sub(r"<script.*?</script>", "", dom, flags=re.S)
text = html.unescape(re.sub(r"\s+", " ", re.sub(r"<[^>]*>", " ", body)))
heads = [re.sub(r"<[^>]*>", "", h) for h in re.findall(r"<h2>(.*?)</h2>", dom)]
plain = text.translate({0x2212: "-", 0x2009: None, 0xa0: " "})
assert heads[:4] == ["1. How well is motion predicted?", "2. What is known?",
                     "3. What is wrong?", "4. What to do next?"], heads
assert 'id="text"' not in dom and "NaN" not in plain and "undefined" not in plain, plain
answers = re.split(r"\d\. [HW][^?]*\?", plain)[1:]
exec(sys.argv[2])
END
# shows NAME CODE: Python sees d, and text and answers of the page as Chromium shows it.
shows() {
    browse --dump-dom "file://$PWD/$1.html" >"$1.dom"
    python3 shown.py "$1" "$2"
}
for name in good sign slow; do
    "$AUVID" fit $name.csv --validate 2.csv --thrusters girona500 --report $name.html >/dev/null
done
check "a good log: the answers are right" shows good '
for k in "uvwr":
    assert "R² %.4f" % d["r2_validation"][k] in answers[0], answers[0]
    assert "[%.4f, %.4f]" % tuple(d["r2_interval"][k]) in answers[0]
for p in d["parameters"]:
    assert p["name"] in answers[1]
assert "%.0f±%.0f kg" % (d["parameters"][0]["estimate"], d["parameters"][0]["half_width"]) \
    in answers[1].replace(" ±", "±").replace("± ", "±"), answers[1]
assert "%+.2f m/s" % d["drag"]["X"][2]["speed"] in answers[1]
assert "No error of thrust" in answers[2] and "up to the thrust scale" in answers[3]
assert d["log_findings"] == [] and "Doubtful" not in plain
assert dom.count("<figure>") == 8 and "dashed" in text'
check "an input of wrong sign: it says first that nothing can be trusted, and why" shows sign '
assert "None of the 13 parameters is identifiable" in plain.split("1. How")[0]
error = d["log_findings"][0]
assert error["code"] == "input_sign" and "Y_N has the wrong sign" in error["sentence"], error
assert error["sentence"] in plain.split("1. How")[0] and error["sentence"] in answers[2]
wrong = d["wrong_inputs"][0]
assert wrong in answers[2] or wrong[0].upper() + wrong[1:] in answers[2]
assert "First remove what is wrong" in answers[3]'
check "a log that is too slow: so does it" shows slow '
assert "Nothing was identified from these data. The rows are about 0.9" in plain.split("1. How")[0]
assert "more than the 0.5 s that fit bridges: log at 5 Hz or faster" in answers[2]
assert "no parameter was identified" in answers[1] and "record a row every 0.2 s" in answers[3]'
if [ "${REPORT_FIGURE:-}" = write ]; then
    browse --window-size=1280,690 --screenshot=report.png "file://$PWD/good.html"
    "$ROOT/third_party/validation/bin/python" -c '
from PIL import Image
Image.open("report.png").convert("RGB").quantize(255, dither=Image.Dither.NONE).save(
    "small.png", optimize=True)'
    cp small.png "$ROOT/tools/python_validation/figures/report.png"
fi
finish
