"""A picture of a page, to look at: shoot.py URL FILE [dark] [phone]."""

import sys

from playwright.sync_api import sync_playwright

url, file, *how = sys.argv[1:]
with sync_playwright() as p:
    browser = p.chromium.launch(executable_path="/usr/bin/chromium", args=["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"])
    size = {"width": 390, "height": 844} if "phone" in how else {"width": 1440, "height": 900}
    page = browser.new_page(viewport=size, color_scheme="dark" if "dark" in how else "light")
    page.on("console", lambda m: print(m.type, m.text))
    page.on("pageerror", lambda e: print("ERROR", e))
    page.goto(url)
    page.wait_for_timeout(1500)
    page.screenshot(path=file)
    browser.close()
