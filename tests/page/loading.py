"""How the page comes, and comes back: a part of page_test.py."""

from browser import Browser
from page_case import PageTest
from served import until

MOST_BYTES = 300_000
MOST_FILES = 26
MOST_WAITS = 1
MOST_TIMES_EMPTY = 8
EMPTY = "dygraphs.txt"  # a licence: no script, no style


class Loading(PageTest):
    def test_little_and_from_nowhere_else(self):
        browser = self.page()
        files = browser.run("""return performance.getEntriesByType("resource")
            .concat(performance.getEntriesByType("navigation"))
            .map(({name, decodedBodySize, duration}) => [name, decodedBodySize, duration])""")
        self.assertLessEqual(sum(size for _, size, _ in files), MOST_BYTES)
        self.assertLessEqual(len(files), MOST_FILES)
        self.assertEqual(browser.complaints(), [])  # the policy forbids other addresses, loudly
        for name, _, _ in files:
            self.assertEqual(name.split("/")[2], self.served.url.split("/")[2])
        loaded_ms = browser.run("return performance.timing.loadEventEnd - "
                                "performance.timing.navigationStart")
        print(f"loaded in {loaded_ms} ms, {sum(size for _, size, _ in files)} bytes")

    def test_no_file_waits_for_one_that_waited(self):
        """Where answers take long, each such wait is seen. index.html asks for all files."""
        browser = Browser(logs=("browser", "performance"))
        self.addCleanup(browser.close)
        browser.open(self.served.url)
        askers = browser.asked_for_by()
        self.assertGreater(len(askers), 10)

        def waits(url):
            return 0 if askers.get(url) is None else 1 + waits(askers[url])

        chains = {url: waits(url) for url in askers}
        self.assertLessEqual(max(chains.values()), MOST_WAITS, chains)

    def test_in_a_few_times_what_an_empty_page_takes(self):
        """Both by the same server, in turn, from an empty cache; the least of some tries, which
        other work on this machine disturbs least."""
        browser = self.page_of_its_own()
        browser.cdp("Network.enable")
        browser.cdp("Network.setCacheDisabled", cacheDisabled=True)

        def load_ms(path):
            browser.driver.get(self.served.url + path)
            return browser.run("""const [{loadEventEnd, startTime}] =
                performance.getEntriesByType("navigation");
                return loadEventEnd - startTime;""")

        empty_ms, page_ms = (min(each) for each in zip(
            *((load_ms(EMPTY), load_ms("")) for _ in range(10))))
        print(f"loaded in {page_ms:.0f} ms; an empty page in {empty_ms:.0f} ms")
        self.assertLess(page_ms, MOST_TIMES_EMPTY * empty_ms)

    def test_its_memories_do_not_grow(self):
        browser = self.page()
        lengths = browser.driver.execute_async_script("""
            const done = arguments[0];
            import("./history.js").then(({Ring, Track}) => {
              const ring = new Ring(10);
              const track = new Track(10, 1);
              for (let i = 0; i < 1000; i += 1) { ring.push(i); track.add(2 * i, 0); }
              const xs = [];
              track.forEach((x) => xs.push(x));
              done([ring.length, ring.at(0), ring.at(-1), track.length, xs[0], xs[9]]);
            });""")
        self.assertEqual(lengths, [10, 990, 999, 10, 1980, 1998])

    def test_what_rounds_to_0_has_no_sign(self):
        texts = self.page().driver.execute_async_script("""
            const done = arguments[0];
            import("./dom.js").then(({fixed, quantity}) => done(
              [fixed(-0.4), fixed(-0.5, 1), fixed(-0.04, 1), fixed(-12.6), quantity(-0, "mA")]));
            """)
        self.assertEqual(texts, ["0", "-0.5", "0.0", "-13", "0 mA"])

    def test_steers_in_a_browser_that_keeps_nothing(self):
        browser = self.page_of_its_own()
        browser.cdp("Page.addScriptToEvaluateOnNewDocument", source="""
            Object.defineProperty(window, "localStorage", {get() { throw new Error("no"); }});""")
        browser.open(self.served.url)
        browser.steer()
        self.assertEqual(browser.complaints(), [])

    def test_what_was_missed_is_said(self):
        browser = self.page()
        browser.driver.execute_async_script("""
            const done = arguments[0];
            Promise.all([import("./feed_link.js"), import("./status.js")]).then(
              ([{FeedLink}, {Status}]) => {
                const link = new FeedLink(new URL("api/feed", location.href));
                new Status(link);
                link.open();
                link.socket.onmessage({data: '{"type":"missed","messages":3}'});
                link.socket.onmessage({data: '{"type":"missed","messages":4}'});
                done();
              });""")
        self.assertIn("missed 7 messages", browser.text("gap"))

    def test_after_the_server_was_away(self):
        browser = self.page()
        browser.steer()
        browser.key("w", down=True)
        self.served.stop()
        until(lambda: "not connected" in browser.text("link"), "a page without a connection")
        self.assertEqual(browser.text("wanted"), "nothing is held")
        self.served.start()
        self.feed.close()
        self.feed = self.served.feed()
        until(lambda: browser.text("link") == "connected", "a page that is connected again")
        self.assertIn("was not connected once", browser.text("gap"))
        self.assertEqual(browser.text("holder"), "nobody steers")
        browser.key("w", down=False)
        self.assert_on_the_map(browser)
        # Chromium itself says that nobody answered.
        for said in browser.complaints():
            self.assertIn("WebSocket connection to", said)
