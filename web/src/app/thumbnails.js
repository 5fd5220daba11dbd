// Small pictures made in the browser: only of what is seen, few at a time, so that 500 photos do not stop the page.
const AT_ONCE = 2;
const WIDTH = 240;  // pixels

export class Thumbnails {
  constructor() {
    this.waiting = new Map();  // element to {blobOf, done}
    this.queue = [];
    this.busy = 0;
    this.observer = new IntersectionObserver((entries) => {
      for (const {target, isIntersecting} of entries) {
        if (isIntersecting && this.waiting.has(target)) this.enqueue(target);
      }
    }, {rootMargin: '200px'});
  }

  // Once the element is seen: blobOf() gives the photo; done(address of the small picture, or null if it cannot be decoded).
  want(element, blobOf, done) {
    this.waiting.set(element, {blobOf, done});
    this.observer.observe(element);
  }

  forget(element) {
    this.waiting.delete(element);
    this.observer.unobserve(element);
  }

  enqueue(element) {
    this.observer.unobserve(element);
    this.queue.push(element);
    this.pump();
  }

  async pump() {
    if (this.busy >= AT_ONCE) return;
    const element = this.queue.shift();
    if (!element) return;
    const job = this.waiting.get(element);
    this.waiting.delete(element);
    if (job) {
      this.busy++;
      job.done(await small(job.blobOf).catch(() => null));
      this.busy--;
    }
    this.pump();
  }
}

async function small(blobOf) {
  const image = await createImageBitmap(await blobOf(), {resizeWidth: WIDTH, resizeQuality: 'medium'});
  const canvas = new OffscreenCanvas(image.width, image.height);
  canvas.getContext('2d').drawImage(image, 0, 0);
  image.close();
  return URL.createObjectURL(await canvas.convertToBlob({type: 'image/jpeg', quality: 0.8}));
}
