#include "app/compare/ComparePage.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

namespace app {
namespace {

using testing::HasSubstr;
using testing::Not;

/// What is wrong with the nesting of a page's elements; empty where nothing is. Scripts and styles are text.
std::string nestingFault(const std::string& html) {
    static const std::set<std::string> empty{"meta", "img", "input", "br"};
    std::vector<std::string> open;
    std::size_t at = 0;
    while ((at = html.find('<', at)) != std::string::npos) {
        if (html.compare(at, 2, "<!") == 0) {
            at = html.find('>', at);
            continue;
        }
        const bool closing = html[at + 1] == '/';
        std::size_t end = at + (closing ? 2 : 1);
        std::string name;
        while (std::isalnum(static_cast<unsigned char>(html[end])) != 0) name += html[end++];
        if (name.empty()) return "a loose < before: " + html.substr(at, 40);
        // Attribute values may hold a >.
        bool quoted = false;
        while (end < html.size() && (quoted || html[end] != '>')) {
            if (html[end] == '"') quoted = !quoted;
            if (html[end] == '<' && !quoted) return "a < within <" + name;
            ++end;
        }
        if (closing) {
            if (open.empty() || open.back() != name)
                return "</" + name + "> closes <" + (open.empty() ? "nothing" : open.back()) + ">";
            open.pop_back();
        } else if (!empty.contains(name)) {
            open.push_back(name);
            if (name == "script" || name == "style") {
                end = html.find("</" + name + ">", end);
                if (end == std::string::npos) return name + " is never closed";
                --end;
            }
        }
        at = end;
    }
    return open.empty() ? "" : "<" + open.back() + "> is never closed";
}

std::string withoutComments(std::string text) {
    for (std::size_t at; (at = text.find("/*!")) != std::string::npos;)
        text.erase(at, text.find("*/", at) + 2 - at);
    return text;
}

std::size_t count(const std::string& text, const std::string& what) {
    std::size_t n = 0;
    for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos; at += what.size()) ++n;
    return n;
}

std::vector<CompareRow> rows() {
    std::vector<CompareRow> all;
    double value = 1;
    for (const std::uint32_t cars : {10u, 100u})
        for (const SweepPoint& point : comparedPoints(true)) {
            CompareRow row;
            row.point = point;
            row.cars = cars;
            row.width = 1280;
            row.height = 720;
            value += 1.01;
            row.frame = {value, value, value, 3};
            row.reflection = {value, value, value, 3};
            row.againstTruth.flip = 1 / value;
            all.push_back(row);
        }
    markFronts(all);
    return all;
}

PageHead head() {
    PageHead h;
    h.city = "paper";
    h.version = "0.1.0";
    h.renderer = "a renderer (LLVM 15, 256 bits)";
    h.cpu = "a processor";
    h.threads = 2;
    h.frames = 4;
    h.truth = "rays";
    h.seed = 77;
    return h;
}

std::vector<PictureStrip> strips() {
    PictureStrip strip;
    strip.cars = 10;
    const Picture grey{8, 4, std::vector<std::uint8_t>(8 * 4 * 4, 100)};
    strip.truth = grey;
    strip.frames.push_back({"mem", "medium", 0.03, grey, grey});
    return {strip};
}

WindowComparison windows() {
    WindowComparison w;
    for (int depth = 0; depth < 4; ++depth) {
        WindowRow row;
        row.name = "depth <" + std::to_string(depth);
        row.depth = depth;
        row.mostMaps = 8;
        row.passes = static_cast<std::uint32_t>(2 * depth);
        row.frame = {10, 10.0 + depth, 20, 3};
        row.ratioToPainted = 1 + 0.125 * depth;
        row.flip = 0.3 / (1 + depth);
        if (depth > 0) row.psnr = 20 + 5.0 * depth;
        w.rows.push_back(row);
    }
    w.strips = strips();
    w.strips.front().title = "windows & cars";
    return w;
}

TEST(ComparePageTest, showsWindowsWhereThereAreAny) {
    const WindowComparison w = windows();
    const std::string page = comparePage(head(), rows(), strips(), w);
    EXPECT_EQ(nestingFault(page), "");
    EXPECT_EQ(count(page, "<tr data-windows="), w.rows.size());
    EXPECT_THAT(page, HasSubstr("<tr data-windows=\"depth &lt;3\">"));
    EXPECT_THAT(page, HasSubstr("<h3>windows &amp; cars</h3>"));
    for (const char* chart : {"<canvas id=\"windows-cost\">", "<canvas id=\"windows-error\">"})
        EXPECT_THAT(page, HasSubstr(chart));
    EXPECT_EQ(count(page, "src=\"data:image/jpeg;base64,/9j/"), 6u) << "the cars' strip and the windows'";
    const std::string opening = "<script type=\"application/json\" id=\"window-data\">";
    const std::size_t begin = page.find(opening) + opening.size();
    const nlohmann::json data =
        nlohmann::json::parse(page.substr(begin, page.find("</script>", begin) - begin));
    ASSERT_EQ(data.size(), w.rows.size());
    for (std::size_t i = 0; i < data.size(); ++i) {
        EXPECT_EQ(data[i]["depth"], w.rows[i].depth);
        EXPECT_EQ(data[i]["passes"], w.rows[i].passes);
        EXPECT_DOUBLE_EQ(data[i]["ratio_to_painted"].get<double>(), w.rows[i].ratioToPainted);
        EXPECT_EQ(data[i]["psnr_db"].is_null(), i == 0) << "not measured: null, not NaN";
    }
    const std::string without = comparePage(head(), rows(), strips());
    EXPECT_THAT(without, Not(HasSubstr("id=\"windows\"")));
    EXPECT_THAT(without, HasSubstr("id=\"window-data\">[]<"));
}

TEST(ComparePageTest, showsCloseChromeWhereThereIsAny) {
    ChromeComparison chrome;
    for (const char* method : {"none", "mem", "chrome", "rerender"}) {
        ChromeRow row;
        row.view = "sphere <beside> a car";
        row.method = method;
        row.frame = {10, 12, 20, 3};
        row.flip = 0.125;
        chrome.rows.push_back(row);
    }
    chrome.strips = strips();
    chrome.strips.front().title = "sphere & car";
    const std::string page = comparePage(head(), rows(), strips(), {}, chrome);
    EXPECT_EQ(nestingFault(page), "");
    EXPECT_EQ(count(page, "<tr data-chrome=\"sphere &lt;beside&gt; a car\">"), 4u);
    EXPECT_THAT(page, HasSubstr("<h3>sphere &amp; car</h3>"));
    EXPECT_THAT(comparePage(head(), rows(), strips()), Not(HasSubstr("id=\"chrome\"")));
    const nlohmann::json row = toJson(chrome.rows[2], "boulevard");
    EXPECT_EQ(row["method"], "chrome");
    EXPECT_EQ(row["compared"], "chrome");
    EXPECT_TRUE(row["psnr_db"].is_null()) << "not measured: null, not NaN";
}

TEST(ComparePageTest, isWellFormed) {
    EXPECT_EQ(nestingFault(comparePage(head(), rows(), strips())), "");
    EXPECT_EQ(nestingFault(comparePage(head(), {}, {})), "");
    // The check itself can fail.
    EXPECT_NE(nestingFault("<p><b></p></b>"), "");
    EXPECT_NE(nestingFault("<p>1 < 2</p>"), "");
    EXPECT_NE(nestingFault("<p>"), "");
}

TEST(ComparePageTest, needsNothingButItself) {
    const std::string page = withoutComments(comparePage(head(), rows(), strips()));
    EXPECT_THAT(page, Not(HasSubstr("http")));
    EXPECT_THAT(page, Not(HasSubstr("<link")));
    EXPECT_THAT(page, Not(HasSubstr("@import")));
    EXPECT_THAT(page, Not(HasSubstr("url(")));
    EXPECT_EQ(count(page, "src=\""), count(page, "src=\"data:image/"));
    EXPECT_EQ(count(page, "src=\"data:image/jpeg;base64,/9j/"), 3u) << "truth, picture and difference";
    EXPECT_THAT(page, HasSubstr("Chart="));
    for (const char* mark : {"@TITLE@", "@STYLE@", "@FACTS@", "@PARTIAL@", "@VERDICTS@", "@STRIPS@", "@ROWS@",
                             "@CHARTS@", "@DATA@", "@WINDOWS@", "@WINDOW_DATA@", "@SCRIPT@"})
        EXPECT_THAT(page, Not(HasSubstr(mark)));
}

TEST(ComparePageTest, holdsEveryRowInTableAndData) {
    const std::vector<CompareRow> all = rows();
    const std::string page = comparePage(head(), all, {});
    EXPECT_EQ(count(page, "<tr data-method="), all.size());
    const std::string opening = "<script type=\"application/json\" id=\"data\">";
    const std::size_t begin = page.find(opening) + opening.size();
    const nlohmann::json data =
        nlohmann::json::parse(page.substr(begin, page.find("</script>", begin) - begin));
    ASSERT_EQ(data.size(), all.size());
    for (std::size_t i = 0; i < all.size(); ++i) {
        EXPECT_EQ(data[i]["setting"], all[i].point.setting);
        EXPECT_EQ(data[i]["title"], all[i].point.title());
        EXPECT_EQ(data[i]["on_front"], all[i].onFront);
        char flip[16];
        std::snprintf(flip, sizeof flip, ">%.4f<", all[i].againstTruth.flip);
        EXPECT_THAT(page, HasSubstr(flip));
    }
}

TEST(ComparePageTest, saysWhereItWasMeasuredAndThatItIsPartial) {
    PageHead h = head();
    const std::string page = comparePage(h, rows(), {});
    for (const char* fact : {"a processor", "a renderer (LLVM 15, 256 bits)", "77", "mirrorstreet 0.1.0",
                             "1280 &times; 720", "rays"})
        EXPECT_THAT(page, HasSubstr(fact));
    EXPECT_THAT(page, Not(HasSubstr("Partial:")));
    h.partial = true;
    EXPECT_THAT(comparePage(h, rows(), {}), HasSubstr("Partial:"));
}

TEST(ComparePageTest, namesFromOutsideAreText) {
    PageHead h = head();
    h.city = "</script><b onclick=\"x\">&'";
    const std::string page = comparePage(h, rows(), strips());
    EXPECT_EQ(nestingFault(page), "");
    EXPECT_THAT(page, Not(HasSubstr("<b onclick")));
    EXPECT_THAT(page, HasSubstr("&lt;/script&gt;&lt;b onclick=&quot;x&quot;&gt;&amp;&#39;"));
}

}  // namespace
}  // namespace app
