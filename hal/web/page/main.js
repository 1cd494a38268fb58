import { SpeedCharts } from "./charts.js";
import { Events } from "./events.js";
import { FeedLink } from "./feed_link.js";
import { Gamepads, Keys, Stick } from "./hands.js";
import { Loop } from "./loop.js";
import { MapHands } from "./map_hands.js";
import { RobotMap } from "./robot_map.js";
import { Sensors } from "./sensors.js";
import { Status } from "./status.js";
import { Steering } from "./steering.js";
import { VirtualCreate } from "./virtual_create.js";

const url = new URL("api/feed", location.href);
url.protocol = location.protocol === "https:" ? "wss:" : "ws:";
url.hash = "";
const link = new FeedLink(url);

const steering = new Steering(link);
new Keys(steering);
new Stick(steering);
new Gamepads(steering);
new Status(link);
new MapHands(new RobotMap(link), link);
new SpeedCharts(link);
new Sensors(link);
new Events(link);
new Loop(link);
new VirtualCreate(link);

link.open();
