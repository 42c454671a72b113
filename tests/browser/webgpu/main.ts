import * as page from './page.js';
import * as three from './three.js';

/** Everything the page can be asked to do. */
export const tasks = { ...page, ...three };

Object.assign(window, { tasks });
